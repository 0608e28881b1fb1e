/* Laws of what an arm may have beyond rigid bodies and paper friction. Joint numbers count from 0 here. */
#ifndef EFFECTS_H
#define EFFECTS_H

typedef struct {
    double law, joint, on_at; /* index into effect_laws, where, from which time [s] */
    double p[8];              /* p[0] is the size; the rest is explained at each law */
} Effect;

typedef struct { double slip[3], slow_qdd; } Memory; /* hysteresis elements; low-passed acceleration */

typedef struct { /* what a law may look at */
    double time, dt;
    const double *q, *qd, *qdd, *load;
} Situation;

typedef struct { /* what it gives: torque the motor must add, dry friction beyond the paper's either way, error of the report */
    double smooth[6], forward[6], backward[6], reported[6];
} Extra;

extern const char *effect_laws[]; /* names, ends with a null pointer */

void apply_effect(const Effect *effect, Memory *memory, const Situation *now, Extra *out);

#endif
