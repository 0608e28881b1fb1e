#include "laws.h"

#include <math.h>
#include <string.h>

enum { PROCESS_FORCE = 15, SLOSHING_TOOL, SPINDLE_GYRO, SPINDLE_UNBALANCE };
enum { BEGUN = 15 };

typedef struct {
    Mat turn;  /* of frame 6 in the base */
    Vec place; /* of its origin */
    Vec speed; /* angular, in frame 6 */
    Vec gravity;
} Tool;

static const Vec TIP = {0.24, 0, 0.162 + 0.085}; /* of the tool, in frame 6 */
static const Vec SPINDLE = {0.15, 0, 0.247};

/* c0 [N] along c3..c5 in the base (c2 = 0) or the tool, at the tip: always (c1 = 0), in cuts of
 * the share c7 of the period c6 from phase c8 (1), or from c6 to c7 (2); ramps of c9, chatter of
 * the share c10 at c11 Hz. */
static void process_force(const double *c, double time, const Tool *tool, Vec force, Vec moment) {
    double on = 1;
    Vec along;
    if ((int)c[1] == 1) {
        const double into = fmod((time + 100 * c[6]) / c[6] + c[8], 1.0) * c[6];
        on = smooth_step(into / c[9]) * (1 - smooth_step((into - c[7] * c[6]) / c[9]));
    } else if ((int)c[1] == 2) {
        on = smooth_step((time - c[6]) / c[9]) * (1 - smooth_step((time - c[7]) / c[9]));
    }
    on *= 1 + c[10] * sin(TWO_PI * c[11] * time);
    if ((int)c[2] == 0)
        turned_back(tool->turn, c + 3, along);
    else
        memcpy(along, c + 3, sizeof(Vec));
    for (int k = 0; k < 3; k++) force[k] = c[0] * on * along[k];
    cross(TIP, force, moment);
}

/* A mass c0 on a spring (c1 [rad/s], damping ratio c2) at c3..c5 of frame 6, free in the base.
 * Kept: its place and speed, and where the spring's foot was. */
static void sloshing_tool(const double *c, double *own, double dt, const Tool *tool, Vec force,
                          Vec moment) {
    const double stiffness = c[0] * c[1] * c[1], damping = 2 * c[2] * c[0] * c[1];
    double *mass = own, *mass_speed = own + 3, *foot_before = own + 6;
    Vec foot, pull;
    turned(tool->turn, c + 3, foot);
    for (int k = 0; k < 3; k++) foot[k] += tool->place[k];
    if (own[BEGUN] == 0) { /* hangs at rest */
        for (int k = 0; k < 3; k++) {
            mass[k] = foot[k] + tool->gravity[k] / (c[1] * c[1]);
            mass_speed[k] = 0;
            foot_before[k] = foot[k];
        }
        own[BEGUN] = 1;
    }
    for (int k = 0; k < 3; k++) {
        const double foot_speed = (foot[k] - foot_before[k]) / dt;
        const double f =
            stiffness * (foot[k] - mass[k]) + damping * (foot_speed - mass_speed[k]);
        foot_before[k] = foot[k];
        pull[k] = -f;
        mass_speed[k] += dt * (f / c[0] + tool->gravity[k]);
        mass[k] += dt * mass_speed[k];
    }
    turned_back(tool->turn, pull, force);
    cross(c + 3, force, moment);
}

/* Angular momentum c0 (of sign c3) along x of frame 6; a share c4 before it spins up from c1 on
 * within c2. */
static void spindle_gyro(const double *c, double time, const Tool *tool, Vec moment) {
    const double grown = c[4] + (1 - c[4]) * smooth_step((time - c[1]) / c[2]);
    const Vec momentum = {c[0] * c[3] * grown, 0, 0};
    cross(tool->speed, momentum, moment);
    for (int k = 0; k < 3; k++) moment[k] = -moment[k];
}

/* A force c0 that turns at c1 Hz from phase c2, its speed swinging by c3. */
static void spindle_unbalance(const double *c, double time, Vec force, Vec moment) {
    const double angle = TWO_PI * c[1] * time + c[2] + c[3] * sin(0.7 * time);
    force[0] = 0;
    force[1] = c[0] * cos(angle);
    force[2] = c[0] * sin(angle);
    cross(SPINDLE, force, moment);
}

static void apply(const Effect *effect, double *own, const Now *now, const Tool *tool, Vec force,
                  Vec moment) {
    const double *c = effect->c;
    switch ((int)effect->law) {
    case PROCESS_FORCE: process_force(c, now->time, tool, force, moment); break;
    case SLOSHING_TOOL: sloshing_tool(c, own, now->dt, tool, force, moment); break;
    case SPINDLE_GYRO: spindle_gyro(c, now->time, tool, moment); break;
    case SPINDLE_UNBALANCE: spindle_unbalance(c, now->time, force, moment); break;
    }
}

static void tool_at(const Plant *plant, const double qd[6], const Posture *at, Tool *tool) {
    double rates[6];
    Vec w = {0, 0, 0}, next;
    frame_6(at, tool->turn, tool->place);
    frame_rates(qd, rates);
    for (int i = 0; i < 6; i++) {
        turned_back(at->turn[i], w, next);
        next[2] += rates[i];
        memcpy(w, next, sizeof(Vec));
    }
    memcpy(tool->speed, w, sizeof(Vec));
    memcpy(tool->gravity, plant->gravity, sizeof(Vec));
}

void tool_wrench(const Plant *plant, Memory *memory, const Now *now, const Posture *at,
                 double wrench[6]) {
    Tool tool;
    int placed = 0;
    memset(wrench, 0, 6 * sizeof(double));
    for (int e = 0; e < (int)plant->effects; e++) {
        Vec force = {0, 0, 0}, moment = {0, 0, 0};
        if ((int)plant->effect[e].law < PROCESS_FORCE) continue;
        if (!placed) tool_at(plant, now->qd, at, &tool);
        placed = 1;
        apply(&plant->effect[e], memory->own[e], now, &tool, force, moment);
        for (int k = 0; k < 3; k++) {
            wrench[k] += force[k];
            wrench[3 + k] += moment[k];
        }
    }
}
