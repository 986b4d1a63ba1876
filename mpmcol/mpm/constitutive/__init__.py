"""Laws of the material. A law is one file in this folder and one line in `LAWS`.

A law's module holds
  Material      the keys of a case file's [material] table, with units, bounds and defaults
  make_params   Material -> a NamedTuple of floats with bulk_modulus and shear_modulus (Pa); its class needs a
                name of its own, since compiled loops find it by name
  STATE         names of its history variables, at most two; they start at zero
  may_yield     (s1, s3, history, params) -> above zero where `return_map` may change the stress
  return_map    (s1 >= s2 >= s3, history, params) -> (s1, s2, s3, history, opening, yields): principal stresses after
                the return, new history, volumetric strain freed at the apex; valid where `yields` is above zero
  apex          (history, params) -> mean stress that an opened point carries, Pa
Formulas are plain functions of numbers, or of vectors of eight points, under `@device`; they choose with
`where_positive`, and run without a compiler, too.
"""

from __future__ import annotations

from types import ModuleType

from mpmcol.mpm.constitutive import elastic, mohr_coulomb, mohr_coulomb_softening

LAWS: dict[str, ModuleType] = {
    "elastic": elastic,
    "mohr-coulomb": mohr_coulomb,
    "mohr-coulomb-softening": mohr_coulomb_softening,
}
