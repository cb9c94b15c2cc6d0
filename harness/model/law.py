"""Columns of the row that a law writes, and where the base parameters lie in the parameter vector.

A law is a plain scalar function that reads its own parameters from ``theta[o:]`` (and the base parameters from their
fixed places), and writes its value and partial derivatives into ``out``, which holds zeros. No slices, no allocation,
no flags: the compiled kernel calls it in its inner loop. What it is given is said by its slot:

    smooth force, modulation     law(x, v, t, theta, o, out), t left out by one that does not change in time
    level of friction            law(v, theta, o, out); value theta[o] at v = 0
    friction by a bristle        law(v, side, z, level, theta, o, out); full deflection level/theta[o]; two rows
    friction without a state     law(v, a, level, theta, o, out); a is the acceleration without friction
    internal states              law(x, v, w0, w1, theta, o, out); row 0 the force, then a row for the rate of each

side is the direction in which it counts as moving, +-1; the speed of a bristle is max(side v, 0).
"""

# places of the base parameters in theta
MASS, VISCOUS, STIFFNESS, KINETIC, STATIC, V_SCALE, FIRST_TERM = range(7)

# columns of out: value, partials by state and time, by mass and stiffness, by the parameters of the law
VALUE, D_X, D_V, D_T, D_MASS, D_STIFFNESS, D_PARAMETER = range(7)
MAX_PARAMETERS = 40
COLUMNS = D_PARAMETER + MAX_PARAMETERS

# friction knows neither mass nor stiffness: there stand its partials by the acceleration without friction and by the
# level it is given (f_k for a level of friction)
D_FREE, D_LEVEL = D_MASS, D_STIFFNESS

# internal states of a law in slot I: their partials follow the parameters
MAX_INTERNAL = 2
D_INTERNAL = COLUMNS
INTERNAL_COLUMNS = COLUMNS + MAX_INTERNAL
