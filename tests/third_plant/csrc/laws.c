#include "laws.h"

#include <math.h>
#include <stddef.h>

enum {
    COULOMB_ASYMMETRY, COULOMB_CHANGE, VISCOUS_CHANGE, VISCOUS_WARMUP, LOAD_FRICTION, HYSTERESIS,
    GEAR_RIPPLE, BALANCER, CABLE_SPRING, WRIST_COUPLING, VISCOUS_POWER, BRAKE_DRAG, FRICTION_ZONE,
    SOFT_STOP, PARALLELOGRAM_FRICTION
};

/* the last four act on the tool: tool_laws.c */
const char *third_laws[] = {
    "coulomb_asymmetry", "coulomb_change", "viscous_change", "viscous_warmup", "load_friction",
    "hysteresis", "gear_ripple", "balancer", "cable_spring", "wrist_coupling", "viscous_power",
    "brake_drag", "friction_zone", "soft_stop", "parallelogram_friction", "process_force",
    "sloshing_tool", "spindle_gyro", "spindle_unbalance", NULL};

enum { BEGUN = 15 }; /* of a law's own memory */

typedef struct {
    double gain[6], added[6];         /* the dry level times one, plus the other */
    double breakaway[6], coulomb[6];  /* levels of dry friction */
    double torque[6];                 /* all the rest */
} Terms;

typedef struct { /* a joint as its law sees it */
    int joint;
    double q, qd, load, viscous;
} Joint;

double smooth_step(double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x); }

static double side(double x) { return x >= 0 ? 1 : -1; }

/* Dry friction larger by c0 in direction c4, smaller by c3 c0 in the other; a share c1 of it stays
 * at speeds far beyond c2. */
static void coulomb_asymmetry(const double *c, const Joint *at, Terms *out) {
    const double kept = c[1] + (1 - c[1]) * exp(-fabs(at->qd) / c[2]);
    out->gain[at->joint] *= 1 + (at->qd * c[4] > 0 ? c[0] * kept : -c[3] * c[0] * kept);
}

/* Both dry levels; the one before motion by c1 times as much. */
static void coulomb_change(const double *c, const Joint *at, Terms *out) {
    out->coulomb[at->joint] *= 1 + c[0];
    out->breakaway[at->joint] *= 1 + c[0] * c[1];
}

/* Share c0 of the viscous friction, with a term c1 of the speed over c2. */
static double viscous_change(const double *c, const Joint *at) {
    return at->viscous * c[0] * at->qd * (1 + c[1] * fabs(at->qd) / c[2]);
}

/* Viscous friction that is c0 larger when cold: falls exponentially (c1 = 0), by the heat of
 * friction (1; c4 its power, c5 its exponent) or like 1 / (1 + (t / T)^c4). c2 is the time, c3 the
 * age or warmth at the beginning. */
static double viscous_warmup(const double *c, double *own, const Now *now, const Joint *at,
                             double coulomb) {
    const double age = (now->time > 0 ? now->time : 0) + c[3];
    const int law = (int)c[1];
    double share;
    if (law == 0) {
        share = c[0] * exp(-age / c[2]);
    } else if (law == 1) {
        if (own[BEGUN] == 0) {
            own[0] = c[3];
            own[BEGUN] = 1;
        }
        const double power = (coulomb * fabs(at->qd) + at->viscous * at->qd * at->qd) / c[4];
        if (now->time > 0) own[0] += now->dt * (power - own[0]) / c[2];
        share = c[0] * exp(-c[5] * own[0]);
    } else {
        share = c[0] / (1 + pow(age / c[2], c[4]));
    }
    return at->viscous * share * at->qd;
}

/* Dry friction by the load's size: soft below c1, exponent c2 about c3, another c4 where the load
 * drives (soft below c5). */
static void load_friction(const double *c, const Joint *at, Terms *out) {
    const double felt = (sqrt(at->load * at->load + c[1] * c[1]) - c[1]) / c[3] + 1e-12;
    out->added[at->joint] +=
        c[0] * (c[3] * pow(felt, c[2])) * (1 + c[4] * tanh(at->load * at->qd / c[5]));
}

/* c1 sliders in parallel (shares from c2, ranges from c8), or with c1 = 0 Dahl's law of range c8
 * and exponent c9. A share c14 of it takes the place of dry friction. */
static void hysteresis(const double *c, double *own, const Joint *at, Terms *out) {
    const int sliders = (int)c[1];
    double force = 0;
    if (own[BEGUN] == 0) {
        own[14] = at->q;
        own[BEGUN] = 1;
    }
    const double moved = at->q - own[14];
    own[14] = at->q;
    for (int i = 0; i < sliders; i++) {
        const double range = c[8 + i];
        own[i] = fmin(fmax(own[i] + moved, -range), range);
        force += c[2 + i] * own[i] / range;
    }
    if (sliders == 0) {
        const double left = 1 - side(moved) * own[0];
        own[0] += moved / c[8] * pow(left < 0 ? 0 : left, c[9]);
        force = own[0];
    }
    out->torque[at->joint] += c[0] * force;
    out->added[at->joint] -= c[14] * c[0];
}

/* c1 periods in the radian, phase c2; second harmonic c3 at phase c4, half order c7 at c9; more by
 * c5 with the load over c6, by c8 with the direction. */
static double gear_ripple(const double *c, const Joint *at) {
    const double load = sqrt(at->load * at->load + 1) / c[6];
    const double size = c[0] * (1 + c[5] * (load - 1)) * (1 + c[8] * tanh(at->qd / 0.05));
    return size * (sin(c[1] * at->q + c[2]) + c[3] * sin(2 * c[1] * at->q + c[4]) +
                   c[7] * sin(0.5 * c[1] * at->q + c[9]));
}

/* Between a crank c2 on the joint and a pivot c3 away: a spring (c1 = 0) of stiffness c6, free
 * length c5 and preload c7, or gas of exponent c6. Its seal rubs by c8. */
static double balancer(const double *c, const Joint *at) {
    const double angle = at->q - c[4];
    const double length = sqrt(c[2] * c[2] + c[3] * c[3] - 2 * c[2] * c[3] * cos(angle));
    const double arm = c[2] * c[3] * sin(angle) / length;
    const double force =
        (int)c[1] == 0 ? c[7] + c[6] * (length - c[5]) : c[7] * pow(c[5] / length, c[6]);
    return c[0] * force * arm * (1 + c[8] * tanh(at->qd / 0.03));
}

/* Of the angle from c1 in units of c2, less what has crept (share c7 within c6): cubic (c3 = 0),
 * saturating (1) or stiffer on one side (2), each by c4. */
static double cable_spring(const double *c, double *own, const Now *now, const Joint *at) {
    const double bent = (at->q - c[1]) / c[2];
    if (own[BEGUN] == 0) {
        own[0] = bent;
        own[BEGUN] = 1;
    }
    own[0] += now->dt * (bent - own[0]) / c[6];
    const double x = bent - c[7] * own[0];
    if ((int)c[3] == 0) return c[0] * (x + c[4] * x * x * x);
    if ((int)c[3] == 1) return c[0] * (tanh(1.3 * x) * (1 + c[4] * fabs(x)));
    return c[0] * (x + c[4] * (x > 0 ? x * x : 0.3 * x * fabs(x)));
}

/* Friction of a speed, viscous by the share c3 (about c5), dry by the rest (within c6). */
static double mixed(const double *c, double speed) {
    return c[0] * (c[3] * speed / c[5] + (1 - c[3]) * tanh(speed / c[6]));
}

/* Joint c1 drives this one: by its own speed (c2 = 0), or through a mesh of ratio c4 that feels the
 * speed of one against the other. */
static void wrist_coupling(const double *c, const Now *now, const Joint *at, Terms *out) {
    const int driver = (int)c[1];
    if ((int)c[2] == 0) {
        out->torque[at->joint] += mixed(c, now->qd[driver]);
        return;
    }
    const double in_mesh = mixed(c, at->qd - c[4] * now->qd[driver]);
    out->torque[at->joint] += in_mesh - mixed(c, at->qd);
    out->torque[driver] -= c[4] * in_mesh;
}

/* c0 at the speed c2, exponent c1. */
static double viscous_power(const double *c, const Joint *at) {
    return c[0] * pow(fabs(at->qd) / c[2] + 1e-12, c[1]) * (at->qd > 0 ? 1 : -1);
}

/* Dry friction from c1 to c2, rising within c3, falling within c4, fading by c5 as it heats; with
 * c6 = 1 more of it c7 times a turn. */
static void brake_drag(const double *c, const Now *now, const Joint *at, Terms *out) {
    const double since = now->time > c[1] ? now->time - c[1] : 0;
    double on = smooth_step((now->time - c[1]) / c[3]) *
                (1 - smooth_step((now->time - c[2]) / c[4]));
    if ((int)c[6] == 1) on *= 0.75 + 0.25 * sin(c[7] * at->q + c[8]);
    out->added[at->joint] += c[0] * on * (1 - c[5] * (1 - exp(-since / 4.0)));
}

/* Dry friction about the angle c1: a bell of width c2 (c3 = 0), a plateau (1), or all beyond it
 * (2); a share c4 of it viscous. */
static void friction_zone(const double *c, const Joint *at, Terms *out) {
    const double u = (at->q - c[1]) / c[2];
    const double inside = (int)c[3] == 0   ? exp(-u * u)
                          : (int)c[3] == 1 ? 1 / (1 + u * u * u * u)
                                           : 0.5 * (1 + tanh(u));
    out->added[at->joint] += c[0] * inside;
    out->torque[at->joint] += c[0] * c[4] * inside * at->qd;
}

/* A cushion from the angle c1 on in direction c4, soft within c2, exponent c3, loss c5. */
static double soft_stop(const double *c, const Joint *at) {
    const double depth = (at->q - c[1]) * c[4] / c[2];
    const double in = depth > 30 ? depth : log1p(exp(depth));
    return c[4] * c[0] * pow(in, c[3]) * (1 + c[5] * tanh(c[4] * at->qd / 0.02));
}

/* Towards its bound at the level g, as far as the joint has moved. */
static double bent_on(double from, double speed, double stiffness, double level, double dt) {
    const double bound = side(speed) * level / stiffness;
    return bound + (from - bound) * exp(-fabs(speed) * stiffness * dt / level);
}

/* A bearing of the rod, which turns by q3 - q2: static share c1 below c2, bristles of c3, a share
 * c4 viscous. */
static void parallelogram_friction(const double *c, double *own, const Now *now, Terms *out) {
    const double speed = now->qd[2] - now->qd[1];
    const double level = c[0] * (1 + c[1] * exp(-speed * speed / (c[2] * c[2])));
    const double stiffness = c[0] / c[3];
    own[0] = bent_on(own[0], speed, stiffness, level, now->dt);
    const double torque = stiffness * own[0] + c[0] * c[4] * speed;
    out->torque[2] += torque;
    out->torque[1] -= torque;
}

static void apply(const Plant *plant, const Effect *effect, double *own, const Now *now,
                  Terms *out) {
    const double *c = effect->c;
    const int j = (int)effect->joint;
    const Joint at = {j, now->q[j], now->qd[j], now->load[j], plant->viscous[j]};
    switch ((int)effect->law) {
    case COULOMB_ASYMMETRY: coulomb_asymmetry(c, &at, out); break;
    case COULOMB_CHANGE: coulomb_change(c, &at, out); break;
    case VISCOUS_CHANGE: out->torque[j] += viscous_change(c, &at); break;
    case VISCOUS_WARMUP:
        out->torque[j] += viscous_warmup(c, own, now, &at, out->coulomb[j]);
        break;
    case LOAD_FRICTION: load_friction(c, &at, out); break;
    case HYSTERESIS: hysteresis(c, own, &at, out); break;
    case GEAR_RIPPLE: out->torque[j] += gear_ripple(c, &at); break;
    case BALANCER: out->torque[j] += balancer(c, &at); break;
    case CABLE_SPRING: out->torque[j] += cable_spring(c, own, now, &at); break;
    case WRIST_COUPLING: wrist_coupling(c, now, &at, out); break;
    case VISCOUS_POWER: out->torque[j] += viscous_power(c, &at); break;
    case BRAKE_DRAG: brake_drag(c, now, &at, out); break;
    case FRICTION_ZONE: friction_zone(c, &at, out); break;
    case SOFT_STOP: out->torque[j] += soft_stop(c, &at); break;
    case PARALLELOGRAM_FRICTION: parallelogram_friction(c, own, now, out); break;
    }
}

/* Bristles (LuGre) with a Stribeck curve, viscous friction, and what the laws add. */
void joint_torques(const Plant *plant, Memory *memory, const Now *now, double out[6]) {
    Terms terms;
    for (int j = 0; j < 6; j++) {
        terms.gain[j] = 1;
        terms.added[j] = 0;
        terms.breakaway[j] = plant->breakaway[j];
        terms.coulomb[j] = plant->coulomb[j];
        terms.torque[j] = 0;
    }
    for (int e = 0; e < (int)plant->effects; e++)
        apply(plant, &plant->effect[e], memory->own[e], now, &terms);
    for (int j = 0; j < 6; j++) {
        const double speed = now->qd[j], slow = speed / plant->stribeck[j];
        const double slowness = exp(-slow * slow);
        const double curve =
            terms.coulomb[j] + (terms.breakaway[j] - terms.coulomb[j]) * slowness;
        const double level = fmax(curve * terms.gain[j] + terms.added[j], 0.05 * plant->coulomb[j]);
        const double stiffness = plant->coulomb[j] / plant->bend[j];
        const double before = memory->bristle[j];
        memory->bristle[j] = bent_on(before, speed, stiffness, level, now->dt);
        out[j] = stiffness * memory->bristle[j] +
                 plant->damping[j] * slowness * (memory->bristle[j] - before) / now->dt +
                 plant->viscous[j] * speed + terms.torque[j];
    }
}
