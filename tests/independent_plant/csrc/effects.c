#include "effects.h"

#include <math.h>
#include <stddef.h>

#include "rigid_body.h"

#define TWO_PI 6.28318530717958647692

enum {
    COULOMB_ASYMMETRY, COULOMB_CHANGE, VISCOUS_CHANGE, VISCOUS_WARMUP, LOAD_FRICTION, HYSTERESIS, GEAR_RIPPLE, BALANCER,
    CABLE_SPRING, WRIST_COUPLING, PROCESS_FORCE, ANGLE_PRODUCT, SPEED_BUMP, STICKY_WINDOW, EVEN_SPEED, OFFSET_DRIFT, HUM,
    END_CUSHION, ANGLE_SPEED, CROSS_SPEED, ACCELERATION_SQUARE, BURSTS, LOAD_SQUARE, ANGLE_BUMP
};

const char *effect_laws[] = {
    "coulomb_asymmetry", "coulomb_change", "viscous_change", "viscous_warmup", "load_friction", "hysteresis",
    "gear_ripple", "balancer", "cable_spring", "wrist_coupling", "process_force", "angle_product", "speed_bump",
    "sticky_window", "even_speed", "offset_drift", "hum", "end_cushion", "angle_speed", "cross_speed",
    "acceleration_square", "bursts", "load_square", "angle_bump", NULL};

static double sign(double x) { return (x > 0.0) - (x < 0.0); }

static double signed_power(double x, double exponent) { return sign(x) * pow(fabs(x), exponent); }

static double bell(double x) { return exp(-x * x); }

static double clamp(double x, double bound) { return fmin(fmax(x, -bound), bound); }

static double dry(Extra *out, int j, double forward, double backward) {
    out->forward[j] += forward;
    out->backward[j] += backward;
    return 0.0;
}

/* Three elastoplastic elements in parallel, yielding after p1, p2, p3 radian. */
static double hysteresis(const double *p, Memory *memory, double travel) {
    static const double share[3] = {0.5, 0.3, 0.2};
    double torque = 0.0;
    for (int i = 0; i < 3; i++) {
        memory->slip[i] = clamp(memory->slip[i] + travel, p[1 + i]);
        torque += share[i] * memory->slip[i] / p[1 + i];
    }
    return p[0] * torque;
}

/* A spring between base and upper arm: lever ratio p1, free length p2, soft limit of its force p3, mounted at p4. */
static double balancer(const double *p, double q) {
    const double angle = q - p[4];
    const double length = sqrt(1.0 + p[1] * p[1] + 2.0 * p[1] * cos(angle));
    return -p[0] * p[3] * tanh((length - p[2]) / p[3]) * sin(angle) / length;
}

/* The motor of the next axis (p4) also turns by p1 times this one's angle, so both feel its friction: a power p3 of speed
 * and some dry friction that sets in at p2. */
static double wrist_coupling(const double *p, const Situation *now, int j, Extra *out) {
    const int next = (int)p[4];
    const double alone = now->qd[next], coupled = alone + p[1] * now->qd[j];
    const double friction = signed_power(coupled, p[3]) + 0.3 * tanh(coupled / p[2]);
    out->smooth[next] += p[0] * (friction - signed_power(alone, p[3]) - 0.3 * tanh(alone / p[2]));
    return p[0] * p[1] * friction;
}

/* Force (p0..p2) on the tool's tip in the base frame, in cuts of length p4 every p3 seconds, with a tooth-passing swing
 * p6 at p5 Hz, ramped within 0.1 s. */
static void process_force(const double *p, const Situation *now, Extra *out) {
    static const Vec tip = TOOL_TIP;
    const double phase = fmod(now->time, p[3]);
    const double ramp = fmax(0.0, fmin(1.0, fmin(phase, p[4] - phase) / 0.1));
    const double level = ramp * (1.0 + p[6] * sin(TWO_PI * p[5] * now->time));
    const double force[3] = {p[0] * level, p[1] * level, p[2] * level};
    double tau[6];
    if (ramp == 0.0) return;
    torque_against_force(now->q, tip, force, tau);
    for (int i = 0; i < 6; i++) out->smooth[i] += tau[i];
}

/* Bursts of 0.4 s at p1 Hz in about a third of the slots of 1.5 s. */
static double bursts(const double *p, double time) {
    const double slot = floor(time / 1.5), hash = sin(slot * 12.9898 + p[2]) * 43758.5453;
    const double since = time - 1.5 * slot - 0.5;
    if (hash - floor(hash) > 0.35 || since < 0.0 || since > 0.4) return 0.0;
    return p[0] * sin(TWO_PI * p[1] * since) * sin(TWO_PI * since / 0.8);
}

void apply_effect(const Effect *effect, Memory *memory, const Situation *now, Extra *out) {
    const double *p = effect->p, t = now->time;
    const int j = (int)effect->joint;
    const double q = now->q[j], v = now->qd[j], load = now->load[j];
    double torque = 0.0, size;
    memory->slow_qdd += fmin(1.0, now->dt / 0.03) * (now->qdd[j] - memory->slow_qdd);
    if ((int)effect->law == HYSTERESIS) torque = hysteresis(p, memory, v * now->dt); /* remembers even while off */
    if (t < effect->on_at) return;
    switch ((int)effect->law) {
    case COULOMB_ASYMMETRY: dry(out, j, p[1] * p[0], -p[2] * p[0]); break;
    case COULOMB_CHANGE: size = p[0] * (1.0 + p[1] * exp(-fabs(v) / p[2])); dry(out, j, size, size); break;
    case VISCOUS_CHANGE: torque = p[0] * signed_power(v, p[1]); break;
    case VISCOUS_WARMUP: torque = p[0] * signed_power(v, p[1]) / pow(1.0 + fmax(t, 0.0) / p[2], p[3]); break;
    case LOAD_FRICTION: size = p[0] * pow(fabs(load), p[1]); dry(out, j, size, size); break;
    case HYSTERESIS: break;
    case GEAR_RIPPLE: torque = p[0] * (sin(p[1] * q + p[2]) + p[3] * sin(2.0 * p[1] * q + p[4])); break;
    case BALANCER: torque = balancer(p, q); break;
    case CABLE_SPRING: torque = p[0] * ((q - p[1]) + p[2] * pow(q - p[1], 3)); break;
    case WRIST_COUPLING: torque = wrist_coupling(p, now, j, out); break;
    case PROCESS_FORCE: process_force(p, now, out); break;
    case ANGLE_PRODUCT: torque = p[0] * (q - p[1]) * (now->q[(int)p[3]] - p[2]); break;
    case SPEED_BUMP: torque = p[0] * sign(v) * bell((fabs(v) - p[1]) / p[2]); break;
    case STICKY_WINDOW: size = p[0] / (1.0 + pow((q - p[1]) / p[2], 8)); dry(out, j, size, size); break;
    case EVEN_SPEED: torque = p[0] * sqrt(fabs(v)); break;
    case OFFSET_DRIFT: torque = p[0] * (1.0 - exp(-fmax(t, 0.0) / p[1])); break;
    case HUM: torque = p[0] * sin(TWO_PI * p[1] * t + p[2]); break;
    case END_CUSHION: torque = p[0] * (q - p[1] - clamp(q - p[1], p[2])); break;
    case ANGLE_SPEED: torque = p[0] * (q - p[1]) * (q - p[1]) * v; break;
    case CROSS_SPEED: torque = p[0] * now->qd[(int)p[3]]; break;
    case ACCELERATION_SQUARE: out->reported[j] += p[0] * memory->slow_qdd * memory->slow_qdd; break;
    case BURSTS: torque = bursts(p, t); break;
    case LOAD_SQUARE: torque = p[0] * load * fabs(load); break;
    case ANGLE_BUMP: torque = p[0] * bell((q - p[1]) / p[2]); break;
    default: break;
    }
    out->smooth[j] += torque;
}
