"""The runner of the trials: what there is to try, processes that carry trials out, and the record of results."""
