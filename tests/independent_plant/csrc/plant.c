/* The arm in closed loop at 4 kHz: reference smoothing, cascaded servo, saturation, dry friction that really sticks,
 * one elastic transmission with backlash. Record and reference at 1 kHz. Instead of its own servo, anybody's controller
 * may drive it at 1 kHz. */
#include <math.h>
#include <string.h>

#include "effects.h"
#include "rigid_body.h"

#define SUBSTEPS 4
static const double DT = 0.001 / SUBSTEPS;

typedef struct { double fs, fc, fv, stribeck; } Friction;
typedef struct { double omega, zeta, kp, kv, ki, forward, inertia, friction, limit; } Servo;
typedef struct { double joint, inertia, stiffness, cubic, damping, gap; } Transmission; /* joint < 0: all rigid */

typedef struct { /* one arm; before and after something is bolted on at change_at [s] */
    Arm before, after;
    double change_at;
    Friction friction[6];
    Servo servo[6];
    double encoder_zero[6];
    Transmission transmission;
} Plant;

typedef struct { double q[6], v[6], motor_q, motor_v, f[6], qdd[6], load[6], smooth_q[6], smooth_v[6], integral[6]; } State;

static double clamp(double x, double low, double high) { return fmin(fmax(x, low), high); }

static void gather(int count, const Effect *effects, Memory *memories, const Situation *now, const Friction *friction,
                   Extra *extra) {
    memset(extra, 0, sizeof *extra);
    for (int i = 0; i < count; i++) apply_effect(&effects[i], &memories[i], now, extra);
    for (int j = 0; j < 6; j++) {
        const Friction *m = &friction[j];
        const double ratio = now->qd[j] / m->stribeck, dry = m->fc + (m->fs - m->fc) * exp(-ratio * ratio);
        extra->smooth[j] += m->fv * now->qd[j];
        extra->forward[j] = fmax(0.0, dry + extra->forward[j]);
        extra->backward[j] = fmax(0.0, dry + extra->backward[j]);
    }
}

/* P position loop, PI speed loop; speed, inertia and dry friction fed forward; the integrator rests while the command does. */
static void servo_torque(const Servo *servo, State *s, const double ref[6], const double rate[6], const double q[6],
                         const double v[6], double u[6]) {
    for (int j = 0; j < 6; j++) {
        const Servo *k = &servo[j];
        const double acc = k->omega * (k->omega * (ref[j] - s->smooth_q[j]) - 2.0 * k->zeta * s->smooth_v[j]);
        s->smooth_v[j] += DT * acc;
        s->smooth_q[j] += DT * s->smooth_v[j];
        const double error = k->kp * (s->smooth_q[j] - q[j]) + k->forward * s->smooth_v[j] - v[j];
        const int resting = fabs(rate[j]) < 1e-5 && fabs(s->smooth_q[j] - q[j]) < 1e-4;
        const double demand = k->kv * error + s->integral[j] + k->inertia * acc + k->friction * tanh(s->smooth_v[j] / 0.01);
        if (!resting && fabs(demand) < k->limit) s->integral[j] += DT * k->ki * error;
        u[j] = clamp(demand, -k->limit, k->limit);
    }
}

/* Cholesky factor, then the inverse of a positive definite 6 x 6 matrix; 0 if it is not. */
static int invert(double M[6][6], double inverse[6][6]) {
    double L[6][6] = {{0}}, W[6][6] = {{0}};
    for (int i = 0; i < 6; i++)
        for (int j = 0; j <= i; j++) {
            double sum = M[i][j];
            for (int k = 0; k < j; k++) sum -= L[i][k] * L[j][k];
            if (i == j && sum <= 0.0) return 0;
            L[i][j] = i == j ? sqrt(sum) : sum / L[j][j];
        }
    for (int j = 0; j < 6; j++)
        for (int i = j; i < 6; i++) { /* W = inverse of L */
            double sum = i == j ? 1.0 : 0.0;
            for (int k = j; k < i; k++) sum -= L[i][k] * W[k][j];
            W[i][j] = sum / L[i][i];
        }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j <= i; j++) {
            double sum = 0.0;
            for (int k = i; k < 6; k++) sum += W[k][i] * W[k][j];
            inverse[i][j] = inverse[j][i] = sum;
        }
    return 1;
}

/* Friction torques that would stop each joint, cut at their bounds (projected Gauss-Seidel on the end-of-step speed). */
static void stick_or_slip(double inverse[6][6], const Extra *extra, double v[6], double f[6]) {
    for (int sweep = 0; sweep < 20; sweep++) {
        double change = 0.0;
        for (int j = 0; j < 6; j++) {
            const double wanted = clamp(f[j] + v[j] / (DT * inverse[j][j]), -extra->backward[j], extra->forward[j]);
            const double step = wanted - f[j];
            if (step == 0.0) continue;
            f[j] = wanted;
            for (int i = 0; i < 6; i++) v[i] -= DT * inverse[i][j] * step;
            change = fmax(change, fabs(step));
        }
        if (change < 1e-6) break;
    }
}

/* Motor behind a spring with a slightly cubic law and a gap; returns the torque handed to the link. */
static double turn_motor(const Transmission *t, State *s, int j, double drive, const Extra *extra) {
    const double twist = s->motor_q - s->q[j], wound = twist - clamp(twist, -t->gap, t->gap);
    const double touching = t->gap > 0.0 && wound == 0.0 ? 0.0 : 1.0;
    const double spring =
        t->stiffness * wound * (1.0 + t->cubic * wound * wound) + touching * t->damping * (s->motor_v - s->v[j]);
    double v = s->motor_v + DT * (drive - spring) / t->inertia;
    const double friction = clamp(v * t->inertia / DT, -extra->backward[j], extra->forward[j]);
    v -= DT * friction / t->inertia;
    s->motor_v = v;
    s->motor_q += DT * v;
    return spring;
}

/* What the motors' encoders are on: link angles, but the motor's own where a transmission lies between. */
static void motor_side(const Plant *plant, const State *s, double q[6], double qd[6]) {
    const int elastic = (int)plant->transmission.joint;
    memcpy(q, s->q, sizeof s->q);
    memcpy(qd, s->v, sizeof s->v);
    if (elastic >= 0) {
        q[elastic] = s->motor_q;
        qd[elastic] = s->motor_v;
    }
}

/* A quarter of a millisecond under the motor torques u; reported (6): what the drives report beyond them. */
static int step(const Plant *plant, int count, const Effect *effects, Memory *memories, double time, const double u[6],
                State *s, double reported[6]) {
    const Arm *arm = time < plant->change_at ? &plant->before : &plant->after;
    const int elastic = (int)plant->transmission.joint;
    double M[6][6], inverse[6][6], bias[6], q[6], qd[6], rhs[6], v[6];
    Extra extra;
    motor_side(plant, s, q, qd);
    const Situation now = {time, DT, q, qd, s->qdd, s->load};
    gather(count, effects, memories, &now, plant->friction, &extra);
    memcpy(reported, extra.reported, sizeof extra.reported);
    equations_of_motion(arm, s->q, s->v, M, bias);
    for (int j = 0; j < 6; j++) rhs[j] = u[j] - extra.smooth[j] - bias[j];
    if (elastic >= 0) {
        rhs[elastic] =
            turn_motor(&plant->transmission, s, elastic, u[elastic] - extra.smooth[elastic], &extra) - bias[elastic];
        extra.forward[elastic] = extra.backward[elastic] = s->f[elastic] = 0.0;
        M[elastic][elastic] -= plant->transmission.inertia;
    }
    if (!invert(M, inverse)) return 0;
    for (int i = 0; i < 6; i++) {
        double acc = 0.0;
        for (int j = 0; j < 6; j++) acc += inverse[i][j] * (rhs[j] - s->f[j]);
        v[i] = s->v[i] + DT * acc;
    }
    stick_or_slip(inverse, &extra, v, s->f);
    for (int j = 0; j < 6; j++) {
        s->qdd[j] = (v[j] - s->v[j]) / DT;
        s->load[j] = rhs[j] - s->f[j] + bias[j];
        s->v[j] = v[j];
        s->q[j] += DT * v[j];
    }
    return 1;
}

static void set_at(const Plant *plant, State *s, const double seen[6], const double speed[6]) {
    memset(s, 0, sizeof *s);
    for (int j = 0; j < 6; j++) {
        s->smooth_q[j] = seen[j];
        s->q[j] = seen[j] - plant->encoder_zero[j];
        s->v[j] = s->smooth_v[j] = speed[j];
    }
    if (plant->transmission.joint >= 0) {
        s->motor_q = s->q[(int)plant->transmission.joint];
        s->motor_v = s->v[(int)plant->transmission.joint];
    }
}

/* Follow the reference (n, 6) [rad] from time start; out (n - 1, 18): seen angles, speeds, motor torques.
 * Returns the number of records written: n - 1, or fewer if the mass matrix lost its definiteness. */
int follow(const Plant *plant, int count, const Effect *effects, double start, int n, const double *ref, double *out) {
    Memory memories[16] = {{{0}, 0}};
    State s;
    double M[6][6], speed[6];
    for (int j = 0; j < 6; j++) speed[j] = (ref[6 + j] - ref[j]) / 0.001;
    set_at(plant, &s, ref, speed);
    equations_of_motion(&plant->before, s.q, s.v, M, s.integral);
    for (int i = 0; i + 1 < n; i++)
        for (int k = 0; k < SUBSTEPS; k++) {
            double now[6], rate[6], record[18], *seen = record, *qd = record + 6, *u = record + 12, reported[6];
            for (int j = 0; j < 6; j++) {
                rate[j] = (ref[6 * (i + 1) + j] - ref[6 * i + j]) / 0.001;
                now[j] = ref[6 * i + j] + k * DT * rate[j];
            }
            motor_side(plant, &s, seen, qd);
            for (int j = 0; j < 6; j++) seen[j] += plant->encoder_zero[j];
            servo_torque(plant->servo, &s, now, rate, seen, qd, u);
            if (!step(plant, count, effects, memories, start + 0.001 * i + k * DT, u, &s, reported)) return i;
            for (int j = 0; j < 6; j++) u[j] += reported[j];
            if (k == 0) memcpy(out + 18 * i, record, sizeof record);
        }
    return n - 1;
}

/* Anybody's controller, asked once a millisecond: angles and speeds as its sensors show them, to torques. */
typedef void (*Drive)(int sample, const double q[6], const double qd[6], double tau[6]);

/* Driven from a standstill at the seen angles (6) from time start on. Encoders of the given step [rad] are read at 4 kHz,
 * their differences low-passed to speeds (corner [rad/s]). A torque acts from the next millisecond on, cut at the limits
 * of the drives; until the first one the brakes' torque acts. out (n, 21): true angles and speeds of the links, torques
 * that act, place of the tool's tip [m]. Returns the number of records written, as `follow` does. */
int driven(const Plant *plant, int count, const Effect *effects, double start, const double *at, double encoder_step,
           double corner, int n, Drive drive, double *out) {
    static const double still[6];
    const double share = 1.0 - exp(-corner * DT);
    Memory memories[16] = {{{0}, 0}};
    State s;
    double M[6][6], next[6], before[6], speed[6] = {0};
    set_at(plant, &s, at, still);
    equations_of_motion(&plant->before, s.q, still, M, next);
    for (int j = 0; j < 6; j++) before[j] = encoder_step * round(at[j] / encoder_step);
    for (int i = 0; i < n; i++) {
        double u[6], *row = out + 21 * i;
        for (int j = 0; j < 6; j++) u[j] = clamp(next[j], -plant->servo[j].limit, plant->servo[j].limit);
        memcpy(row, s.q, sizeof s.q);
        memcpy(row + 6, s.v, sizeof s.v);
        memcpy(row + 12, u, sizeof u);
        tool_tip(s.q, row + 18);
        drive(i, before, speed, next);
        for (int k = 0; k < SUBSTEPS; k++) {
            double q[6], qd[6], reported[6];
            if (!step(plant, count, effects, memories, start + 0.001 * i + k * DT, u, &s, reported)) return i;
            motor_side(plant, &s, q, qd);
            for (int j = 0; j < 6; j++) {
                const double shown = encoder_step * round((q[j] + plant->encoder_zero[j]) / encoder_step);
                speed[j] += share * ((shown - before[j]) / DT - speed[j]);
                before[j] = shown;
            }
        }
    }
    return n;
}

/* Torques (n, 6) that a prescribed motion (n, 18: q, qd, qdd; dt apart) asks for; the transmission is taken as rigid. */
void prescribed(const Plant *plant, int count, const Effect *effects, double start, double dt, int n, const double *motion,
                double *out) {
    Memory memories[16] = {{{0}, 0}};
    for (int i = 0; i < n; i++) {
        const double *q = motion + 18 * i, *qd = q + 6, *qdd = q + 12, time = start + i * dt;
        double load[6], true_q[6], *tau = out + 6 * i;
        Extra extra;
        for (int j = 0; j < 6; j++) true_q[j] = q[j] - plant->encoder_zero[j];
        inverse_dynamics(time < plant->change_at ? &plant->before : &plant->after, true_q, qd, qdd, load);
        const Situation now = {time, dt, true_q, qd, qdd, load};
        gather(count, effects, memories, &now, plant->friction, &extra);
        for (int j = 0; j < 6; j++)
            tau[j] = load[j] + extra.smooth[j] + extra.reported[j] +
                     (qd[j] > 0.0 ? extra.forward[j] : qd[j] < 0.0 ? -extra.backward[j] : 0.0);
    }
}

/* Free motion without motors, friction or effects: energy is to stay. states (n, 12). */
int swing(const Arm *arm, double dt, int n, double *states) {
    for (int i = 0; i + 1 < n; i++) {
        double x[12], k[4][12];
        for (int stage = 0; stage < 4; stage++) {
            static const double node[4] = {0.0, 0.5, 0.5, 1.0};
            double M[6][6], inverse[6][6], bias[6];
            for (int a = 0; a < 12; a++) x[a] = states[12 * i + a] + (stage ? node[stage] * dt * k[stage - 1][a] : 0.0);
            equations_of_motion(arm, x, x + 6, M, bias);
            if (!invert(M, inverse)) return i;
            for (int a = 0; a < 6; a++) {
                k[stage][a] = x[6 + a];
                k[stage][6 + a] = 0.0;
                for (int b = 0; b < 6; b++) k[stage][6 + a] -= inverse[a][b] * bias[b];
            }
        }
        for (int a = 0; a < 12; a++)
            states[12 * (i + 1) + a] =
                states[12 * i + a] + dt / 6.0 * (k[0][a] + 2.0 * k[1][a] + 2.0 * k[2][a] + k[3][a]);
    }
    return n - 1;
}
