/* Whether rows of a plan lie near a move that is straight in space and turns the shortest way, at even speed; what
 * LinearMoves._close in linear_moves.py does with arrays, up to the first row that is too far away. */
#include <math.h>
#include <stdint.h>

#define NO_TURN 1e-9

/* p [n][3] places [m]; quaternions [n][4] of unit length, each of the sign next to the one before; way [n] from the
 * first row to each; tolerance [m] and angle [rad] of the rows between first and last. */
int linear_close(int64_t first, int64_t last, const double *p, const double *quaternions, const double *way,
                 double tolerance, double angle)
{
    const double *start = p + 3 * first, *end = p + 3 * last;
    const double *from = quaternions + 4 * first, *to = quaternions + 4 * last;
    const double length = way[last] - way[first];
    double along = 0.0, between = 0.0;
    for (int k = 0; k < 4; k++) { along += from[k] * to[k]; }
    const double sign = along < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 4; k++) { between += (sign * to[k] - from[k]) * (sign * to[k] - from[k]); }
    const double half = 2.0 * asin(fmin(0.5 * sqrt(between), 1.0));
    for (int64_t i = first; i <= last; i++) {
        const double share = length > 0.0 ? (way[i] - way[first]) / length : (double)(i - first) / (double)(last - first);
        double away = 0.0;
        for (int k = 0; k < 3; k++) {
            const double d = start[k] + share * (end[k] - start[k]) - p[3 * i + k];
            away += d * d;
        }
        double before = 1.0 - share, after = share;
        if (half > NO_TURN) {
            before = sin(half * before) / sin(half);
            after = sin(half * after) / sin(half);
        }
        const double *planned = quaternions + 4 * i;
        double move[4], same = 0.0, chord = 0.0;
        for (int k = 0; k < 4; k++) {
            move[k] = before * from[k] + after * sign * to[k];
            same += move[k] * planned[k];
        }
        for (int k = 0; k < 4; k++) {
            const double d = move[k] - (same < 0.0 ? -planned[k] : planned[k]);
            chord += d * d;
        }
        /* false for what is no number, too */
        if (!(sqrt(away) <= tolerance && 4.0 * asin(fmin(0.5 * sqrt(chord), 1.0)) <= angle)) { return 0; }
    }
    return 1;
}
