/* Rigid-body dynamics of the arm: recursive Newton-Euler about centres of mass (paper, eqs. 57-68). */
#ifndef RIGID_BODY_H
#define RIGID_BODY_H

#define TOOL_TIP {0.240, 0.0, 0.085 + 0.162} /* the spindle's, in frame 6 */

typedef double Vec[3];

typedef struct { /* everything that has inertia or weight; SI units */
    double link[6][10]; /* mass, centre of mass (3), Ixx Iyy Izz Ixy Ixz Iyz about it, in link axes */
    double gravity[3];  /* direction and size of free fall, base frame */
    double rod[4];      /* parallelogram rod: mass, crank radius, crank phase, distance along the upper arm */
    double rotor[6];    /* reflected rotor inertia */
} Arm;

/* Torque on the six actuators for a motion of the actuators: M qdd + C qd + G. */
void inverse_dynamics(const Arm *arm, const double q[6], const double qd[6], const double qdd[6], double tau[6]);
/* The same of n states. */
void inverse_dynamics_rows(const Arm *arm, int n, const double q[][6], const double qd[][6],
                           const double qdd[][6], double tau[][6]);
/* Mass matrix and bias torque (C qd + G) at once. */
void equations_of_motion(const Arm *arm, const double q[6], const double qd[6], double M[6][6], double bias[6]);
/* Torques that hold the arm against a force [base frame] which pulls at a point of link 6. */
void torque_against_force(const double q[6], const Vec point, const Vec force, double tau[6]);
/* Place of the tool's tip in the base frame. */
void tool_tip(const double q[6], Vec tip);
/* The same of n postures. */
void tool_tips(int n, const double q[][6], Vec tips[]);

#endif
