/* Rigid bodies of the arm about the origins of their frames: torque, mass matrix, places. */
#ifndef THIRD_RIGID_BODY_H
#define THIRD_RIGID_BODY_H

typedef double Vec[3];
typedef double Mat[9]; /* row by row */

/* One body in its frame: mass, m c (3), Ixx Iyy Izz Ixy Ixz Iyz about the frame's origin. */
typedef double Body[10];

typedef struct { /* rotation and origin of each frame in the one before */
    Mat turn[6];
    Vec place[6];
} Posture;

/* Axis 3 of the parallelogram is absolute: the frame turns by q3 - q2. */
void frame_rates(const double q[6], double rates[6]);
Posture posture(const double q[6]);

void cross(const Vec a, const Vec b, Vec out);
void turned(const Mat r, const Vec x, Vec out);      /* R x */
void turned_back(const Mat r, const Vec x, Vec out); /* R' x */

/* M qdd + C qd + G less what a wrench (force, moment; frame 6, at its origin; or null) gives. */
void rigid_torque(const Body link[6], const Vec gravity, const Posture *at, const double qd[6],
                  const double qdd[6], const double *wrench, double tau[6]);
void mass_matrix(const Body link[6], const Posture *at, double M[6][6]);
/* Solves A x = b in place of b; A is lost. Cholesky, pivots held above 1e-9. */
void solve(double A[6][6], double b[6]);
/* Rotation and origin of frame 6 in the base. */
void frame_6(const Posture *at, Mat turn, Vec place);

#endif
