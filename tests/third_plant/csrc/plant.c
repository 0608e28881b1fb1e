/* The arm along a given motion, and in a closed loop with its servo. Leapfrog: speeds stand half a
 * step before angles; a state in between is half a step of acceleration ahead. */
#include <math.h>
#include <string.h>

#include "laws.h"

typedef struct { /* of the servo: position, speed and integral gains, shares of what is fed ahead */
    double kp[6], kd[6], ki[6], inertia_ahead, friction_ahead;
} Gains;

typedef struct { /* what is commanded at one instant */
    double q[6], qd[6], qdd[6];
} Command;

typedef struct { /* of the links, and of the motor behind the spring */
    double q[6], qd[6], qdd[6];
    double motor_q, motor_qd, motor_qdd;
} State;

/* Torques of the motors (rigid transmissions), and of the rigid bodies alone, along a motion. */
void replay(const Plant *plant, int n, double start, double dt, const double q[][6],
            const double qd[][6], const double qdd[][6], double tau[][6], double rigid[][6]) {
    Memory memory;
    memset(&memory, 0, sizeof memory);
    for (int i = 0; i < n; i++) {
        double wrench[6], extra[6];
        const Posture at = posture(q[i]);
        const Now now = {start + i * dt, dt, q[i], qd[i], rigid[i]};
        tool_wrench(plant, &memory, &now, &at, wrench);
        rigid_torque(plant->link, plant->gravity, &at, qd[i], qdd[i], wrench, rigid[i]);
        joint_torques(plant, &memory, &now, extra);
        for (int j = 0; j < 6; j++)
            tau[i][j] = rigid[i][j] + extra[j] + plant->rotor[j] * qdd[i][j];
    }
}

/* PID about the command, with torques fed ahead from the numbers that the servo believes. How many
 * motors would have given more than they can is returned. */
static int servo(const Plant *believed, const Gains *gains, const double *limit, const Command *to,
                 const double q[6], const double qd[6], double dt, double integral[6],
                 double u[6]) {
    double ahead[6], wanted[6];
    const Posture at = posture(to->q);
    int cut = 0;
    for (int j = 0; j < 6; j++) wanted[j] = gains->inertia_ahead * to->qdd[j];
    rigid_torque(believed->link, believed->gravity, &at, to->qd, wanted, 0, ahead);
    for (int j = 0; j < 6; j++) {
        const double off = to->q[j] - q[j], speed_off = to->qd[j] - qd[j];
        const double friction =
            believed->coulomb[j] * tanh(to->qd[j] / 0.03) + believed->viscous[j] * to->qd[j];
        integral[j] += gains->ki[j] * off * dt;
        u[j] = ahead[j] + gains->friction_ahead * friction + gains->kp[j] * off +
               gains->kd[j] * speed_off + integral[j];
        cut += fabs(u[j]) > limit[j];
        u[j] = fmin(fmax(u[j], -limit[j]), limit[j]);
    }
    return cut;
}

/* Torque of the transmission that gives way, of its twist and the twist's rate. */
static double spring_torque(const Plant *plant, double twist, double rate) {
    if (plant->gap > 0) { /* nothing inside the play */
        const double half = plant->gap / 2;
        const double y = twist > half ? twist - half : twist < -half ? twist + half : 0;
        const double torque = plant->stiffness * y * (1 + plant->stiffening * y * y);
        return y != 0 ? torque + plant->spring_damping * rate : torque;
    }
    return plant->stiffness * twist * (1 + plant->stiffening * twist * twist) +
           plant->spring_damping * rate;
}

/* Acceleration of the motor's side. It is light: the speed gain is taken implicitly. */
static double motor_side(const Plant *plant, double kd, double limit, double friction,
                         double torque, double dt, double motor_qdd, double *u) {
    const double asked = *u + kd * 0.5 * dt * motor_qdd;
    const double next = (asked - friction - torque) / (plant->motor_inertia + 0.5 * dt * kd);
    *u = fmin(fmax(asked - kd * 0.5 * dt * next, -limit), limit);
    return (*u - friction - torque) / plant->motor_inertia;
}

/* With the spring twisted by the load, so that nothing swings in. */
static State at_command(const Plant *plant, const Command *from) {
    State s;
    memcpy(s.q, from->q, sizeof s.q);
    memcpy(s.qd, from->qd, sizeof s.qd);
    memcpy(s.qdd, from->qdd, sizeof s.qdd);
    const int joint = (int)plant->spring_joint;
    s.motor_q = s.q[joint];
    s.motor_qd = s.qd[joint];
    s.motor_qdd = 0;
    if (plant->has_spring > 0) {
        double load[6];
        const Posture at = posture(s.q);
        rigid_torque(plant->link, plant->gravity, &at, s.qd, s.qdd, 0, load);
        double twist = load[joint] / plant->stiffness;
        if (plant->gap > 0) twist += (load[joint] > 0 ? 1 : -1) * plant->gap / 2;
        s.q[joint] = s.motor_q - twist;
    }
    return s;
}

/* Accelerations of the links and of the motor's side under the motors' torques u. */
static void accelerations(const Plant *plant, Memory *memory, const Gains *gains,
                          const double *limit, const State *s, double time, double dt,
                          const double half_qd[6], const double seen_q[6],
                          const double seen_qd[6], double u[6], double qdd[6], double *motor_qdd) {
    const double still[6] = {0, 0, 0, 0, 0, 0};
    const int joint = (int)plant->spring_joint;
    double M[6][6], wrench[6], bias[6], load[6], extra[6];
    const Posture at = posture(s->q);
    const Now of_links = {time, dt, s->q, half_qd, 0};
    tool_wrench(plant, memory, &of_links, &at, wrench);
    rigid_torque(plant->link, plant->gravity, &at, half_qd, still, wrench, bias);
    mass_matrix(plant->link, &at, M);
    for (int j = 0; j < 6; j++) { /* with the accelerations of the step before */
        load[j] = bias[j];
        for (int k = 0; k < 6; k++) load[j] += M[j][k] * s->qdd[k];
    }
    const Now of_motors = {time, dt, seen_q, seen_qd, load};
    joint_torques(plant, memory, &of_motors, extra);
    for (int j = 0; j < 6; j++) {
        qdd[j] = u[j] - bias[j] - extra[j];
        M[j][j] += plant->rotor[j];
    }
    if (plant->has_spring > 0) { /* friction and motor act on the other side of the spring */
        const double twist = s->motor_q - s->q[joint];
        const double rate = s->motor_qd + 0.5 * dt * s->motor_qdd - half_qd[joint];
        const double torque = spring_torque(plant, twist, rate);
        *motor_qdd = motor_side(plant, gains->kd[joint], limit[joint], extra[joint], torque, dt,
                                s->motor_qdd, &u[joint]);
        M[joint][joint] -= plant->motor_inertia;
        qdd[joint] = torque - bias[joint];
    }
    solve(M, qdd);
}

/* Closed loop along a command. What is seen goes to q, qd, qdd, u; a joint with a spring is seen at
 * its motor, its link's angle goes to `link`. Returned: how often a motor was at its limit after
 * time 0, or -1 - i where the arm ran away at sample i. */
int simulate(const Plant *plant, const Plant *believed, int n, double start, double dt,
             const Command *command, const Gains *gains, const double *limit, double q[][6],
             double qd[][6], double qdd[][6], double u[][6], double *link) {
    Memory memory;
    double integral[6] = {0, 0, 0, 0, 0, 0};
    State s = at_command(plant, command);
    const int spring = plant->has_spring > 0, joint = (int)plant->spring_joint;
    int cut = 0;
    memset(&memory, 0, sizeof memory);
    for (int i = 0; i < n; i++) {
        const double time = start + i * dt;
        double half_qd[6], seen_q[6], seen_qd[6], motor_qdd = 0;
        for (int j = 0; j < 6; j++) {
            half_qd[j] = s.qd[j] + 0.5 * dt * s.qdd[j];
            seen_q[j] = s.q[j];
            seen_qd[j] = half_qd[j];
        }
        if (spring) {
            seen_q[joint] = s.motor_q;
            seen_qd[joint] = s.motor_qd + 0.5 * dt * s.motor_qdd;
        }
        const int over =
            servo(believed, gains, limit, &command[i], seen_q, seen_qd, dt, integral, u[i]);
        cut += time >= 0 ? over : 0;
        accelerations(plant, &memory, gains, limit, &s, time, dt, half_qd, seen_q, seen_qd, u[i],
                      qdd[i], &motor_qdd);
        link[i] = s.q[joint];
        for (int j = 0; j < 6; j++) {
            const double before = s.qd[j];
            s.qd[j] += dt * qdd[i][j];
            if (!(fabs(s.qd[j]) < 100)) return -1 - i;
            q[i][j] = s.q[j];
            qd[i][j] = 0.5 * (before + s.qd[j]);
            s.q[j] += dt * s.qd[j];
            s.qdd[j] = qdd[i][j];
        }
        if (spring) {
            const double before = s.motor_qd;
            s.motor_qd += dt * motor_qdd;
            q[i][joint] = s.motor_q;
            qd[i][joint] = 0.5 * (before + s.motor_qd);
            qdd[i][joint] = motor_qdd;
            s.motor_q += dt * s.motor_qd;
            s.motor_qdd = motor_qdd;
        }
    }
    return cut;
}

void mass_matrix_of(const Plant *plant, const double q[6], double M[6][6]) {
    const Posture at = posture(q);
    mass_matrix(plant->link, &at, M);
}

/* Rotation (9) and origin (3) of frame 6 at n postures. */
void frames_6(int n, const double q[][6], double out[][12]) {
    for (int i = 0; i < n; i++) {
        const Posture at = posture(q[i]);
        frame_6(&at, out[i], out[i] + 9);
    }
}

int plant_size(void) { return sizeof(Plant) / sizeof(double); }
