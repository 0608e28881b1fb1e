/* One image, three tools: the table that is passed to the step says which one the arm carries.

   Prints a line for each tool: name, status, torque command [Nm]. */
#include <stdio.h>
#include "arm.h"

typedef struct {
    const char *name;
    arm_real_t mass;          /* kg, beside the tool of the robot file */
    arm_real_t com[3];        /* m, in the flange's frame */
    arm_real_t hose;          /* Nm/rad, its pull on axis 4; 0: this tool has none */
    arm_real_t hose_at;       /* rad, where the hose does not pull */
} carried_t;

static const carried_t CARRIED[3] = {
    { "spindle", 0, { 0, 0, 0 }, 0, 0 },
    { "gripper", 4.5f, { 0.02f, -0.01f, 0.12f }, 0, 0 },
    { "torch", 2.5f, { 0.05f, 0, 0.2f }, 6.0f, 0.4f },
};

static arm_parameters_t tables[3];

/* Once, at start-up: a table of its own for each tool, tested. */
static uint32_t prepare(arm_state_t *state)
{
    uint32_t status = 0;
    for (int k = 0; k < 3; k++) {
        const carried_t *tool = &CARRIED[k];
        tables[k] = arm_default_parameters;
        /* payload_moments and payload_products likewise, for a body that is no point */
        tables[k].payload_mass[0] = tool->mass;
        for (int i = 0; i < 3; i++) {
            tables[k].payload_com[i] = tool->com[i];
        }
        tables[k].cable_spring_4_stiffness_Nm_rad[0] = tool->hose;
        tables[k].cable_spring_4_neutral_rad[0] = tool->hose_at;
        status |= arm_init(state, &tables[k]);
    }
    return status;
}

int main(void)
{
    static arm_state_t state;
    static const arm_input_t input = {
        { 0.3f, 0.2f, -0.1f, 0.5f, 0.8f, 0.4f }, { 0.2f, 0.1f, -0.3f, 0.4f, 0.2f, -0.5f },
        { 0.3f, 0.2f, -0.1f, 0.5f, 0.8f, 0.4f }, { 0.2f, 0.1f, -0.3f, 0.4f, 0.2f, -0.5f },
        { 1.0f, -0.5f, 0.5f, 2.0f, -2.0f, 3.0f },
    };
    uint32_t status = prepare(&state);
    for (int k = 0; k < 3; k++) {
        arm_output_t command;
        /* the tool changer says k: from this sample on its table counts */
        status |= arm_step(&state, &input, &tables[k], &command);
        (void)printf("%s %u", CARRIED[k].name, (unsigned)status);
        for (int i = 0; i < 6; i++) {
            (void)printf(" %.4f", (double)command.tau[i]);
        }
        (void)printf("\n");
    }
    return (int)status;
}
