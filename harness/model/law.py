"""Columns of the row that a law writes, and where the base parameters lie in the parameter vector.

A law is a plain scalar function ``law(x, v, t, theta, o, out)``: it reads its own parameters from ``theta[o:]`` (and
the base parameters from their fixed places), and writes its value and partial derivatives into ``out``, which holds
zeros. No slices, no allocation, no flags: the compiled kernel calls it in its inner loop.
"""

# places of the base parameters in theta
MASS, VISCOUS, STIFFNESS, KINETIC, STATIC, V_SCALE, FIRST_TERM = range(7)

# columns of out: value, partials by state and time, by mass and stiffness, by up to three parameters of the law
VALUE, D_X, D_V, D_T, D_MASS, D_STIFFNESS, D_PARAMETER = range(7)
MAX_PARAMETERS = 3
COLUMNS = D_PARAMETER + MAX_PARAMETERS

# internal states of a law in slot I: their partials follow the parameters
MAX_INTERNAL = 2
D_INTERNAL = COLUMNS
INTERNAL_COLUMNS = COLUMNS + MAX_INTERNAL
