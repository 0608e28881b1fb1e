/* What the arm has beyond rigid bodies: friction of the joints, and laws that an effect brings. */
#ifndef THIRD_LAWS_H
#define THIRD_LAWS_H

#include "rigid_body.h"

#define SLOTS 6   /* effects of one arm at most */
#define NUMBERS 22 /* of one effect at most; what they are is said at each law */
#define TWO_PI 6.283185307 /* of frequencies; ten digits, as in the first logs */

typedef struct {
    double law, joint; /* index into third_laws; 0 to 5 */
    double c[NUMBERS]; /* c[0] is the size */
} Effect;

typedef struct { /* everything that is in SI units */
    Body link[6];
    Vec gravity;
    double rotor[6]; /* inertia at the joint */
    /* dry friction before and in motion, viscous friction, Stribeck speed; angle over which the
     * bristles bend, their damping */
    double breakaway[6], coulomb[6], viscous[6], stribeck[6], bend[6], damping[6];
    /* one transmission that gives way: whether there is one, its joint, stiffness, damping, inertia
     * of the motor's side, play, stiffening */
    double has_spring, spring_joint, stiffness, spring_damping, motor_inertia, gap, stiffening;
    double effects; /* how many */
    Effect effect[SLOTS];
} Plant;

typedef struct {
    double bristle[6];
    double own[SLOTS][16]; /* of each effect's law; the last is 1 once it has begun */
} Memory;

typedef struct { /* what a law may look at */
    double time, dt;
    const double *q, *qd, *load; /* load: torque of the rigid bodies */
} Now;

extern const char *third_laws[]; /* names; a null pointer ends them */

double smooth_step(double x); /* 0 below 0, 1 beyond 1, a cubic between */

/* Torque of friction and joint laws that the motors give on top of the rigid bodies. */
void joint_torques(const Plant *plant, Memory *memory, const Now *now, double out[6]);
/* Force and moment of the tool's effects on link 6: in frame 6, at its origin. */
void tool_wrench(const Plant *plant, Memory *memory, const Now *now, const Posture *at,
                 double wrench[6]);

#endif
