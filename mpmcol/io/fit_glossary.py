"""What fit.json holds: meaning and unit of each key, for the glossary of JSON output."""

from __future__ import annotations

from mpmcol.io.glossary import Names

FIT: Names = {
    "schema": ("", "version of the format"),
    "folder": ("", "folder of the fit"),
    "unknowns": ("", "unknown keys of the case"),
    "unknowns.key": ("", "key of the case"),
    "unknowns.unit": ("", "unit of its values"),
    "unknowns.low": ("", "start of its range"),
    "unknowns.high": ("", "end of its range"),
    "unknowns.value": ("", "value with the least misfit"),
    "unknowns.standard_error": ("", "standard error of the value; null if it is not determined"),
    "unknowns.parts": ("", "standard errors by cause, whose squares add up to that of the standard error"),
    "unknowns.parts.measurement": ("", "part of the standard error by the errors of the measured values"),
    "unknowns.parts.grid": ("", "part by the error of the grid in runout and height, from the shipped study"),
    "unknowns.parts.scatter": ("", "part by the scatter of repeated runs"),
    "correlation": ("", "correlation matrix of the unknowns; null if they are not determined"),
    "targets": ("", "measured quantities"),
    "targets.name": ("", "name of the quantity"),
    "targets.unit": ("", "unit of the quantity"),
    "targets.measured": ("", "measured value, or heights of a measured profile"),
    "targets.standard_error": ("", "standard error of each measured value, stated or assumed"),
    "targets.fitted": ("", "the same quantity with the fitted values"),
    "targets.x": ("m", "distances from the wall or axis at which a profile is compared; otherwise empty"),
    "front": ("", "definition of the front of zeta"),
    "chi_squared": ("", "sum of squares of the differences in standard errors"),
    "degrees_of_freedom": ("", "number of measured values less that of the unknowns"),
    "grid": ("", "grid of the answer"),
    "grid.cells": ("", "r_i / h"),
    "grid.overrides": ("", "values of the case that the accuracy replaced"),
    "grid.errors": ("", "relative standard errors by the grid; null if they were not studied"),
    "grid.errors.runout": ("", "relative standard error of the runout by the grid"),
    "grid.errors.height": ("", "relative standard error of the height by the grid"),
    "remarks": ("", "remarks on the answer, for example that the measurements do not determine an unknown"),
    "runs": ("", "number of runs"),
    "core_seconds": ("s", "processor time of all runs, without compilation"),
}
