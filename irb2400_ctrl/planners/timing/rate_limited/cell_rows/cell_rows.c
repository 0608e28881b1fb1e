/* The rows of all inner cells of a RateLimitedProgram: slacks, their change in a direction, and what a step of
 * Newton's method needs of their slopes, which are never stored (`interpreted.py` says the same in numpy).
 *
 * m cells; in each 12 rows for every one of k outputs (value from above and below, rate from above and below, at
 * three places) and 4 rows that are linear in the unknowns. Cells are the last axis of every array, so that the
 * compiler takes several at once. The unknowns of cell i are z[i], z[i + 1], z[i + 2].
 *
 * Every row is a function of the motion (x, u, u') at its place, which is linear in the unknowns.
 */
#include <math.h>
#include <stdint.h>

#define CHUNK 64
#define LANES 64

/* what a program has, pointers of `CellRows` */
typedef struct {
    int64_t m, k;
    const double *h;         /* [m] */
    const double *parabolas; /* [5][k][3][m] Bernstein coefficients of a, b, e, c_high, c_low */
    const double *per_limit; /* [k][m] */
    const double *per_rate;  /* [k][m] */
    const double *kept;      /* [2][k][m] */
    const double *scale;     /* [3][m] */
    const double *motion;    /* [7][3][m] x at the places, u at the places, u' from the unknowns */
    const double *linear;    /* [4][3][m] slopes of the linear rows */
    const double *offset;    /* [4] and their constants */
} cell_rows;

/* Bernstein polynomials of degree 2 at the places, and their slopes */
static const double VALUE[3][3] = {{1, 0, 0}, {0.25, 0.5, 0.25}, {0, 0, 1}};
static const double SLOPE[3][3] = {{-2, 2, 0}, {-1, 0, 1}, {0, -2, 2}};

/* the motion at place p of n cells from `first` on */
typedef struct { double x[CHUNK], u[CHUNK], bend[CHUNK], root[CHUNK]; } places;

static inline double from_unknowns(const cell_rows *c, int row, int64_t i, const double *z)
{
    const double *by = c->motion + 3 * c->m * row + i;
    return by[0] * z[i] + by[c->m] * z[i + 1] + by[2 * c->m] * z[i + 2];
}

static inline void move(const cell_rows *c, int p, int64_t first, int64_t n, const double *z, places *at)
{
    for (int64_t i = 0; i < n; i++) { at->x[i] = from_unknowns(c, p, first + i, z); }
    for (int64_t i = 0; i < n; i++) { at->u[i] = from_unknowns(c, 3 + p, first + i, z); }
    for (int64_t i = 0; i < n; i++) { at->bend[i] = from_unknowns(c, 6, first + i, z); }
    for (int64_t i = 0; i < n; i++) { at->root[i] = sqrt(at->x[i]); }
}

static inline double value(const double *f, int64_t m, int p)
{
    return VALUE[p][0] * f[0] + VALUE[p][1] * f[m] + VALUE[p][2] * f[2 * m];
}

static inline double slope(const double *f, int64_t m, int p)
{
    return SLOPE[p][0] * f[0] + SLOPE[p][1] * f[m] + SLOPE[p][2] * f[2 * m];
}

/* slopes of value and rate of output j at place p of cell i by x, u, u', and of the spare rate by x */
typedef struct { double value_x, value_u, rate_x, rate_u, rate_bend, spare_x, spare; } slopes;

static inline slopes slopes_at(const cell_rows *c, int64_t j, int p, int64_t i, double x, double u, double root)
{
    const int64_t m = c->m, at = j * 3 * m + i, next = 3 * c->k * m;
    const double per_h = 1 / c->h[i];
    const double a = value(c->parabolas + at, m, p), da = per_h * slope(c->parabolas + at, m, p);
    const double b = value(c->parabolas + next + at, m, p), db = per_h * slope(c->parabolas + next + at, m, p);
    const double e = value(c->parabolas + 2 * next + at, m, p), de = per_h * slope(c->parabolas + 2 * next + at, m, p);
    const double per_limit = c->per_limit[j * m + i];
    const double factor = c->scale[p * m + i] * c->per_rate[j * m + i];
    const double per_root = 1 / root, viscous = (e * u + de * x) * per_root;
    slopes s;
    s.value_x = (b + e * per_root / 2) * per_limit;
    s.value_u = a * per_limit;
    s.rate_x = factor * (db + de * per_root - viscous / (2 * x));
    s.rate_u = factor * (da + 2 * b + e * per_root);
    s.rate_bend = factor * a;
    s.spare = c->kept[(c->k + j) * m + i] * c->scale[p * m + i] * per_root;
    s.spare_x = -s.spare / (2 * x);
    return s;
}

/* z [m + 2]; bottom, top [k][m] dry friction; out: slack [k][4][3][m] and [4][m]; product [k + 1][m] of the slacks
 * of an output, and of the linear ones */
void slacks(const cell_rows *c, const double *z, const double *bottom, const double *top, double *slack,
            double *product)
{
    const int64_t m = c->m, k = c->k, next = 3 * k * m;
    for (int64_t i = 0; i < (k + 1) * m; i++) { product[i] = 1; }
    for (int64_t first = 0; first < m; first += CHUNK) {
        const int64_t n = m - first < CHUNK ? m - first : CHUNK;
        for (int p = 0; p < 3; p++) {
            places at;
            move(c, p, first, n, z, &at);
            for (int64_t j = 0; j < k; j++) {
                double *restrict out = slack + (12 * j + p) * m + first;
                double *restrict all = product + j * m + first;
                for (int64_t l = 0; l < n; l++) {
                    const int64_t i = first + l;
                    const double *f = c->parabolas + j * 3 * m + i;
                    const double per_h = 1 / c->h[i], x = at.x[l], u = at.u[l], root = at.root[l];
                    const double a = value(f, m, p), da = per_h * slope(f, m, p);
                    const double b = value(f + next, m, p), db = per_h * slope(f + next, m, p);
                    const double e = value(f + 2 * next, m, p), de = per_h * slope(f + 2 * next, m, p);
                    const double high = value(f + 3 * next, m, p), dhigh = per_h * slope(f + 3 * next, m, p);
                    const double low = value(f + 4 * next, m, p), dlow = per_h * slope(f + 4 * next, m, p);
                    const double per_limit = c->per_limit[j * m + i];
                    const double factor = c->scale[p * m + i] * c->per_rate[j * m + i];
                    const double y = a * u + b * x + e * root;
                    const double change = (da + 2 * b) * u + a * at.bend[l] + db * x + (e * u + de * x) / root;
                    const double kept = c->kept[j * m + i];
                    const double spare = c->kept[(k + j) * m + i] * c->scale[p * m + i] / root;
                    out[l] = kept - (y + high + top[j * m + i]) * per_limit;
                    out[3 * m + l] = kept + (y + low + bottom[j * m + i]) * per_limit;
                    out[6 * m + l] = spare - factor * (change + dhigh);
                    out[9 * m + l] = spare + factor * (change + dlow);
                    all[l] *= out[l] * out[3 * m + l] * out[6 * m + l] * out[9 * m + l];
                }
            }
        }
    }
    for (int q = 0; q < 4; q++) {
        const double *by = c->linear + 3 * q * m;
        double *restrict out = slack + (12 * k + q) * m;
        double *restrict all = product + k * m;
        for (int64_t i = 0; i < m; i++) {
            out[i] = c->offset[q] + by[i] * z[i] + by[m + i] * z[i + 1] + by[2 * m + i] * z[i + 2];
            all[i] *= out[i];
        }
    }
}

/* the change of every slack in the direction dz [m + 2], over the slack: relative [12 k + 4][m] */
void along(const cell_rows *c, const double *z, const double *dz, const double *slack, double *relative)
{
    const int64_t m = c->m, k = c->k;
    for (int64_t first = 0; first < m; first += CHUNK) {
        const int64_t n = m - first < CHUNK ? m - first : CHUNK;
        for (int p = 0; p < 3; p++) {
            places at, by;
            move(c, p, first, n, z, &at);
            move(c, p, first, n, dz, &by);
            for (int64_t j = 0; j < k; j++) {
                const double *own = slack + (12 * j + p) * m + first;
                double *restrict out = relative + (12 * j + p) * m + first;
                for (int64_t l = 0; l < n; l++) {
                    const slopes s = slopes_at(c, j, p, first + l, at.x[l], at.u[l], at.root[l]);
                    const double value = s.value_x * by.x[l] + s.value_u * by.u[l];
                    const double rate = s.rate_x * by.x[l] + s.rate_u * by.u[l] + s.rate_bend * by.bend[l];
                    const double spare = s.spare_x * by.x[l];
                    out[l] = -value / own[l];
                    out[3 * m + l] = value / own[3 * m + l];
                    out[6 * m + l] = (spare - rate) / own[6 * m + l];
                    out[9 * m + l] = (spare + rate) / own[9 * m + l];
                }
            }
        }
    }
    for (int q = 0; q < 4; q++) {
        const double *by = c->linear + 3 * q * m, *own = slack + (12 * k + q) * m;
        double *restrict out = relative + (12 * k + q) * m;
        for (int64_t i = 0; i < m; i++) {
            out[i] = (by[i] * dz[i] + by[m + i] * dz[i + 1] + by[2 * m + i] * dz[i + 2]) / own[i];
        }
    }
}

enum { X1, U1, B1, X2, U2, B2, XX, XU, XB, UU, UB, BB, SPARE, SUMS };

/* weighted sums of slopes at place p */
static void add_place(const cell_rows *c, int p, int64_t first, int64_t n, const places *at, const double *slack,
                      const double *multipliers, double mu, double sum[SUMS][CHUNK])
{
    const int64_t m = c->m;
    for (int q = 0; q < SUMS; q++) {
        for (int64_t l = 0; l < n; l++) { sum[q][l] = 0; }
    }
    for (int64_t j = 0; j < c->k; j++) {
        const double *own = slack + (12 * j + p) * m + first;
        const double *by = multipliers + (12 * j + p) * m + first;
        for (int64_t l = 0; l < n; l++) {
            const slopes s = slopes_at(c, j, p, first + l, at->x[l], at->u[l], at->root[l]);
            const double one[4] = {1 / own[l], 1 / own[3 * m + l], 1 / own[6 * m + l], 1 / own[9 * m + l]};
            const double two[4] = {by[l], by[3 * m + l], by[6 * m + l], by[9 * m + l]};
            const double value_1 = mu * (one[1] - one[0]), rate_1 = mu * (one[3] - one[2]);
            const double value_2 = two[1] - two[0], rate_2 = two[3] - two[2];
            const double both_1 = mu * (one[2] + one[3]), both_2 = two[2] + two[3];
            const double value = two[0] * one[0] + two[1] * one[1];
            const double up = two[3] * one[3], down = two[2] * one[2], rate = up + down, apart = up - down;
            sum[X1][l] += value_1 * s.value_x + rate_1 * s.rate_x + both_1 * s.spare_x;
            sum[U1][l] += value_1 * s.value_u + rate_1 * s.rate_u;
            sum[B1][l] += rate_1 * s.rate_bend;
            sum[X2][l] += value_2 * s.value_x + rate_2 * s.rate_x + both_2 * s.spare_x;
            sum[U2][l] += value_2 * s.value_u + rate_2 * s.rate_u;
            sum[B2][l] += rate_2 * s.rate_bend;
            sum[XX][l] += value * s.value_x * s.value_x + rate * (s.rate_x * s.rate_x + s.spare_x * s.spare_x)
                        + 2 * apart * s.spare_x * s.rate_x;
            sum[XU][l] += value * s.value_x * s.value_u + (rate * s.rate_x + apart * s.spare_x) * s.rate_u;
            sum[XB][l] += (rate * s.rate_x + apart * s.spare_x) * s.rate_bend;
            sum[UU][l] += value * s.value_u * s.value_u + rate * s.rate_u * s.rate_u;
            sum[UB][l] += rate * s.rate_u * s.rate_bend;
            sum[BB][l] += rate * s.rate_bend * s.rate_bend;
            sum[SPARE][l] += both_2 * s.spare;
        }
    }
}

/* slack, multipliers [12 k + 4][m]; out, to be zero before: pulled [2][m][3] slopes times mu / slack and times the
 * multipliers, by the unknowns of each cell; squares [2][m][3][3] slopes times multipliers / slack times slopes, and
 * what the bend of the spare rates takes from the Hessian */
void sums(const cell_rows *c, const double *z, const double *slack, const double *multipliers, double mu,
          double *pulled, double *squares)
{
    const int64_t m = c->m, k = c->k;
    double sum[SUMS][CHUNK];
    for (int64_t first = 0; first < m; first += CHUNK) {
        const int64_t n = m - first < CHUNK ? m - first : CHUNK;
        for (int p = 0; p < 3; p++) {
            places at;
            move(c, p, first, n, z, &at);
            add_place(c, p, first, n, &at, slack, multipliers, mu, sum);
            for (int64_t l = 0; l < n; l++) {
                const int64_t i = first + l;
                const double bend = 0.75 * sum[SPARE][l] / (at.x[l] * at.x[l]);
                double x[3], u[3], b[3];
                for (int q = 0; q < 3; q++) {
                    x[q] = c->motion[(3 * p + q) * m + i];
                    u[q] = c->motion[(3 * (3 + p) + q) * m + i];
                    b[q] = c->motion[(18 + q) * m + i];
                }
                for (int q = 0; q < 3; q++) {
                    pulled[3 * i + q] += sum[X1][l] * x[q] + sum[U1][l] * u[q] + sum[B1][l] * b[q];
                    pulled[3 * (m + i) + q] += sum[X2][l] * x[q] + sum[U2][l] * u[q] + sum[B2][l] * b[q];
                    for (int r = 0; r < 3; r++) {
                        squares[9 * i + 3 * q + r] +=
                            sum[XX][l] * x[q] * x[r] + sum[UU][l] * u[q] * u[r] + sum[BB][l] * b[q] * b[r]
                            + sum[XU][l] * (x[q] * u[r] + u[q] * x[r]) + sum[XB][l] * (x[q] * b[r] + b[q] * x[r])
                            + sum[UB][l] * (u[q] * b[r] + b[q] * u[r]);
                        squares[9 * (m + i) + 3 * q + r] += bend * x[q] * x[r];
                    }
                }
            }
        }
    }
    for (int row = 0; row < 4; row++) {
        for (int64_t i = 0; i < m; i++) {
            const int64_t at = (12 * k + row) * m + i;
            for (int q = 0; q < 3; q++) {
                const double by = c->linear[(3 * row + q) * m + i];
                pulled[3 * i + q] += mu / slack[at] * by;
                pulled[3 * (m + i) + q] += multipliers[at] * by;
                for (int r = 0; r < 3; r++) {
                    squares[9 * i + 3 * q + r] += multipliers[at] / slack[at] * by * c->linear[(3 * row + r) * m + i];
                }
            }
        }
    }
}

/* largest parts of slacks, and of multipliers, that the whole step takes: out [2] */
void steepest(int64_t rows, const double *slack, const double *multipliers, const double *relative, double mu,
              double *out)
{
    double primal[LANES] = {0}, dual[LANES] = {0};
    for (int64_t first = 0; first < rows; first += LANES) {
        const int64_t n = rows - first < LANES ? rows - first : LANES;
        double down[LANES] = {0}, change[LANES] = {0};
        for (int64_t l = 0; l < n; l++) {
            const int64_t t = first + l;
            down[l] = -relative[t];
            change[l] = 1 + relative[t] - mu / (slack[t] * multipliers[t]);
        }
        for (int l = 0; l < LANES; l++) {
            primal[l] = down[l] > primal[l] ? down[l] : primal[l];
            dual[l] = change[l] > dual[l] ? change[l] : dual[l];
        }
    }
    out[0] = out[1] = 0;
    for (int l = 0; l < LANES; l++) {
        out[0] = primal[l] > out[0] ? primal[l] : out[0];
        out[1] = dual[l] > out[1] ? dual[l] : out[1];
    }
}

/* multipliers after a step, in place: towards mu / slack, and within a factor of it at the new slacks */
void updated(int64_t rows, const double *slack, const double *relative, const double *new_slack, double mu, double step,
             double spread, double *restrict multipliers)
{
    for (int64_t t = 0; t < rows; t++) {
        const double central = mu / new_slack[t];
        double v = multipliers[t] + step * (mu / slack[t] - multipliers[t] * (1 + relative[t]));
        v = v < central / spread ? central / spread : v;
        multipliers[t] = v > central * spread ? central * spread : v;
    }
}
