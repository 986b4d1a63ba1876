"""Layout of the records of material points and nodes: which lane of which vector holds what.

A record consists of vectors of eight doubles: three per point in two dimensions, four in three, one per node. The
columns of the velocity gradient L and of the stress s are in the lanes that momentum and force have in a node, so
that P2G needs no shuffles:

    lane        0      1     2     3      4     5     6     7
    vector 0    m      v_x   v_y   v_z    x     y     z     V0
    vector x    J      L_xx  L_yx  L_zx   s_xx  s_xy  s_xz  e_o
    vector y    id     L_xy  L_yy  L_zy   s_xy  s_yy  s_yz  kind
    vector z    q_0    L_xz  L_yz  L_zz   s_xz  s_yz  s_zz  q_1
    node        m      mv_x  mv_y  mv_z   f_x   f_y   f_z   m q      after P2G
    node        m      v~_x  v~_y  v~_z   a_x   a_y   a_z   q        after the grid update

In two dimensions there is no vector z. The lanes that it leaves in the vectors x and y hold what is still needed of it:

    vector x    J      L_xx  L_yx  L_zz   s_xx  s_xy  s_zz  e_o
    vector y    id     L_xy  L_yy  q_0    s_xy  s_yy  q_1   kind

y is vertical. Plane strain: z is out of plane and L_zz = 0. Axisymmetry: x is the radius r, y the axis, zz the hoop
direction, L_zz = v_r / r; masses and volumes are per radian. `e_o` is the opening strain, `q_0` and `q_1` are the
history variables of the constitutive law, `kind` is 0 for the column and 1 for the base, `q` of a node is the stress
that the stress filter averages. Between steps, APIC stores its affine matrix in the lanes of L.
"""

from __future__ import annotations

LANES = 8  # doubles in a vector
RECORD_SIZE = {2: 3 * LANES, 3: 4 * LANES}  # doubles in the record of a point, by dimension
X_VECTOR, Y_VECTOR, Z_VECTOR = LANES, 2 * LANES, 3 * LANES  # where the columns of L and s start in a record

# vector 0 of a point; displacements and the work along each axis use the lanes of the coordinates
M, VX, VY, VZ, X, Y, Z, V0 = range(LANES)
# sums over nodes have velocities in VX, VY, VZ, and accelerations in these
AX, AY, AZ = X, Y, Z
Q = V0  # of nodes, and of sums over nodes: the filtered stress
# other lanes that are the same in two and three dimensions
J, OPENING, ID, KIND = X_VECTOR, X_VECTOR + 7, Y_VECTOR, Y_VECTOR + 7
# in two dimensions
L_ZZ, S_ZZ = X_VECTOR + 3, X_VECTOR + 6

# lane of L[a, b]
L = {
    2: ((9, 17), (10, 18)),
    3: ((9, 17, 25), (10, 18, 26), (11, 19, 27)),
}
L_DIAGONAL = {2: (9, 18, L_ZZ), 3: (9, 18, 27)}  # lanes of L_xx, L_yy, L_zz
SIGMA = {2: (12, 21, S_ZZ, 13), 3: (12, 21, 30, 13, 22, 14)}  # xx yy zz xy yz xz
# second lane of the shear stresses, which are stored in two columns, by index in SIGMA
SIGMA_COPIES = {2: {3: 20}, 3: {3: 20, 4: 29, 5: 28}}
HISTORY = {2: slice(19, 23, 3), 3: slice(24, 32, 7)}
