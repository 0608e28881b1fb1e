/*@ bit_types */
#if REAL_IS_FLOAT
typedef uint32_t bits_t;
typedef int32_t signed_bits_t;
#define ONE_BITS 0x3F800000u
#define SIGN_SHIFT 31
#else
typedef uint64_t bits_t;
typedef int64_t signed_bits_t;
#define ONE_BITS 0x3FF0000000000000uLL
#define SIGN_SHIFT 63
#endif

/*@ bits : bit_types */
/* The bit pattern of a real and back; a copy of equal size, which every compiler turns into a register move. */
static inline real_t from_bits(bits_t bits)
{
    real_t x;
    (void)memcpy((unsigned char *)&x, (const unsigned char *)&bits, sizeof(x));
    return x;
}

static inline bits_t to_bits(real_t x)
{
    bits_t bits;
    (void)memcpy((unsigned char *)&bits, (const unsigned char *)&x, sizeof(bits));
    return bits;
}

/*@ exponent : bits */
#if REAL_IS_FLOAT
#define EXPONENT_SHIFT 23
#define EXPONENT_BIAS 127
#else
#define EXPONENT_SHIFT 52
#define EXPONENT_BIAS 1023
#endif

/*@ abs */
static inline real_t own_abs(real_t x)
{
#if defined(__GNUC__) && REAL_IS_FLOAT
    return __builtin_fabsf(x);
#elif defined(__GNUC__)
    return __builtin_fabs(x);
#else
    return (x > R(0.0)) ? x : (R(0.0) - x);
#endif
}

/*@ round : bits */
/* Adding and taking away 1.5 * 2^23 (2^52) rounds to the nearest integer, ties to even. */
#if REAL_IS_FLOAT
#define ROUNDER R(12582912.0)
#else
#define ROUNDER R(6755399441055744.0)
#endif

/*@ sincos : round */
/* sin and cos together, without a branch: x = k pi + r, |r| <= pi/2, both times (-1)^k.
   Domain |x| <= 1600 (float), 3e6 (double); absolute error <= 1.7e-7 (float), 3.2e-16 (double). */
typedef struct {
    real_t s;
    real_t c;
} sincos_t;

static inline sincos_t own_sincos(real_t x)
{
    const real_t shifted = (x * R(0.3183098861837907)) + ROUNDER;
    const real_t k = shifted - ROUNDER;
    const real_t sign = from_bits(ONE_BITS | (to_bits(shifted) << SIGN_SHIFT));
#if REAL_IS_FLOAT
    const real_t r = (x - (k * R(3.1414794921875))) - (k * R(0.00011316140229323846));
    const real_t z = r * r;
    const real_t p = R(-0.16666660450094894) + (z * (R(0.008333087804457632)
        + (z * (R(-0.00019811083129576504) + (z * R(2.608861194509025e-06))))));
    const real_t q = R(-0.5) + (z * (R(0.041666655751584444) + (z * (R(-0.001388856868808201)
        + (z * (R(2.476927248404601e-05) + (z * R(-2.619315006218835e-07))))))));
#else
    const real_t r = (x - (k * R(3.1415926534682512))) - (k * R(1.2154201013012384e-10));
    const real_t z = r * r;
    const real_t p = R(-0.16666666666666666) + (z * (R(0.008333333333333212)
        + (z * (R(-0.00019841269841215187) + (z * (R(2.755731921211411e-06)
        + (z * (R(-2.5052106958456223e-08) + (z * (R(1.6058943838930292e-10)
        + (z * (R(-7.643094951707073e-13) + (z * R(2.7222248225952303e-15))))))))))))));
    const real_t q = R(-0.5) + (z * (R(0.04166666666666583) + (z * (R(-0.0013888888888829874)
        + (z * (R(2.4801587285744587e-05) + (z * (R(-2.7557317064226743e-07)
        + (z * (R(2.0876592347926815e-09) + (z * (R(-1.1463628406873261e-11)
        + (z * R(4.6160547596040914e-14))))))))))))));
#endif
    const real_t t = sign * r;
    const sincos_t result = { t + ((t * z) * p), sign + ((sign * z) * q) };
    return result;
}

/*@ sin : sincos */
static inline real_t own_sin(real_t x)
{
    const sincos_t both = own_sincos(x);
    return both.s;
}

/*@ cos : sincos */
static inline real_t own_cos(real_t x)
{
    const sincos_t both = own_sincos(x);
    return both.c;
}

/*@ tan : sincos */
static inline real_t own_tan(real_t x)
{
    const sincos_t both = own_sincos(x);
    return both.s / both.c;
}

/*@ expm1_parts : round exponent */
/* x = n ln2 + r: scale = 2^n (0 below, infinity above the range of reals), reduced = exp(r) - 1, |r| <= ln2 / 2. */
typedef struct {
    real_t scale;
    real_t reduced;
} exponential_t;

static inline exponential_t own_expm1_parts(real_t x)
{
    const real_t k = ((x * R(1.4426950408889634)) + ROUNDER) - ROUNDER;
    /* what is no number counts as the lowest here, and stays none in r */
    const int32_t bottom = -EXPONENT_BIAS;
    const int32_t top = EXPONENT_BIAS + 1;
    const real_t above = (k > R(bottom)) ? k : R(bottom);
    const real_t inside = (above < R(top)) ? above : R(top);
    const int32_t clipped = (int32_t)inside + EXPONENT_BIAS;
#if REAL_IS_FLOAT
    const real_t r = (x - (k * R(0.693145751953125))) - (k * R(1.4286068203094173e-06));
    const real_t e = R(0.49999993533215575) + (r * (R(0.16666521157867678) + (r * (R(0.04166837709305781)
        + (r * (R(0.00836867455123065) + (r * R(0.001381490798661354))))))));
#else
    const real_t r = (x - (k * R(0.6931471804855391))) - (k * R(7.440617110012397e-11));
    const real_t e = R(0.5) + (r * (R(0.16666666666666682) + (r * (R(0.041666666666666116)
        + (r * (R(0.008333333333317356) + (r * (R(0.0013888888889110379) + (r * (R(0.00019841269895739952)
        + (r * (R(2.4801586931874022e-05) + (r * (R(2.75572353959283e-06)
        + (r * (R(2.755757969487149e-07) + (r * (R(2.5111879096064708e-08)
        + (r * R(2.082687095932607e-09))))))))))))))))))));
#endif
    const exponential_t result = { from_bits((bits_t)clipped << EXPONENT_SHIFT), r + ((r * r) * e) };
    return result;
}

/*@ exp : expm1_parts */
/* Domain |x| <= 1e9; 0 below -87.6 (float), -708 (double), infinity above 88.3, 709.4; relative error <= 2 ulp. */
static inline real_t own_exp(real_t x)
{
    const exponential_t e = own_expm1_parts(x);
    return e.scale * (R(1.0) + e.reduced);
}

/*@ expm1 : expm1_parts */
/* Domain -1e9 <= x <= 88 (float), 709 (double); <= 3 ulp. */
static inline real_t own_expm1(real_t x)
{
    const exponential_t e = own_expm1_parts(x);
    return (e.scale - R(1.0)) + (e.scale * e.reduced);
}

/*@ tanh : expm1 */
/* (exp(2x) - 1) / (exp(2x) + 1); saturated at |x| = 20, where the reals cannot tell it from 1; <= 4 ulp. */
static inline real_t own_tanh(real_t x)
{
    const real_t low = (x < R(-20.0)) ? R(-20.0) : x;
    const real_t e = own_expm1(R(2.0) * ((low > R(20.0)) ? R(20.0) : low));
    return e / (e + R(2.0));
}

/*@ sinh : abs expm1 */
/* Domain |x| <= 88 (float), 709 (double); <= 4 ulp. */
static inline real_t own_sinh(real_t x)
{
    const real_t e = own_expm1(own_abs(x));
    const real_t size = R(0.5) * (e + (e / (e + R(1.0))));
    return (x < R(0.0)) ? -size : size;
}

/*@ cosh : exp */
/* Domain |x| <= 88 (float), 709 (double); <= 4 ulp. */
static inline real_t own_cosh(real_t x)
{
    const real_t e = own_exp(x);
    return R(0.5) * (e + (R(1.0) / e));
}

/*@ sqrt : exponent */
/* Correctly rounded for normal numbers; 0 and infinity stay, NaN for x < 0. In hardware where the compiler may use it
   without calling a library (-fno-math-errno); else x = m 4^n with m in [1, 4), Newton's iteration on m, and one step
   with the exact remainder, which gives the same bits. */
static inline real_t own_sqrt(real_t x)
{
#if defined(__NO_MATH_ERRNO__) && REAL_IS_FLOAT && (defined(__SSE2__) || defined(__aarch64__) || defined(__ARM_FP))
    return __builtin_sqrtf(x);
#elif defined(__NO_MATH_ERRNO__) && !REAL_IS_FLOAT && (defined(__SSE2__) || defined(__aarch64__))
    return __builtin_sqrt(x);
#else
    const bits_t one = ONE_BITS;
    const bits_t bias = EXPONENT_BIAS;
    const bits_t exponent = to_bits(x) >> EXPONENT_SHIFT;
    const bits_t even = (exponent & 1u) ^ 1u;
    const bits_t mantissa = to_bits(x) & (((bits_t)1u << EXPONENT_SHIFT) - 1u);
    const real_t m = from_bits((one + (even << EXPONENT_SHIFT)) | mantissa);
#if REAL_IS_FLOAT
    const real_t splitter = R(4097.0);
    real_t y = from_bits(0x1FBD1DF5u + (to_bits(m) >> 1));
#else
    const real_t splitter = R(134217729.0);
    real_t y = from_bits(0x1FF7A3BEA91D9B1BuLL + (to_bits(m) >> 1));
    y = R(0.5) * (y + (m / y));
#endif
    y = R(0.5) * (y + (m / y));
    y = R(0.5) * (y + (m / y));
    y = R(0.5) * (y + (m / y));
    const real_t scaled = splitter * y;
    const real_t high = scaled - (scaled - y);
    const real_t low = y - high;
    const real_t product = y * y;
    const real_t rest = (((high * high) - product) + (R(2.0) * (high * low))) + (low * low);
    y = y + (((m - product) - rest) / (y + y));
    /* the root of the last number below 4 lies closer to 2 than a quotient can tell, but below the middle */
    const real_t last = from_bits((one + ((bits_t)1u << EXPONENT_SHIFT)) - 1u);
    y = (y < last) ? y : last;
    const bits_t half = ((exponent + bias) - even) >> 1;
    const real_t root = from_bits(to_bits(y) + ((half - bias) << EXPONENT_SHIFT));
    const bool ordinary = (x > R(0.0)) && ((x - x) == R(0.0));
    return ordinary ? root : ((x < R(0.0)) ? ((x - x) / R(0.0)) : x);
#endif
}

/*@ log : exponent */
/* Normal numbers x > 0, x = m 2^e with m in [sqrt(1/2), sqrt(2)); NaN for the others; <= 2 ulp. */
static inline real_t own_log(real_t x)
{
    const bits_t shifted = to_bits(x) + (ONE_BITS - to_bits(R(0.7071067811865476)));
    const int32_t e = (int32_t)(shifted >> EXPONENT_SHIFT) - EXPONENT_BIAS;
    const bits_t mantissa = (((bits_t)1u << EXPONENT_SHIFT) - 1u) & shifted;
    const real_t m = from_bits(mantissa + to_bits(R(0.7071067811865476)));
    const real_t f = m - R(1.0);
    const real_t s = f / (m + R(1.0));
    const real_t z = s * s;
    const real_t n = (real_t)e;
#if REAL_IS_FLOAT
    const real_t p = R(0.666666656433771) + (z * (R(0.40000335704604617)
        + (z * (R(0.2853727345630364) + (z * R(0.2358285979904394))))));
    const real_t high = R(0.693145751953125);
    const real_t low = R(1.4286068203094173e-06);
#else
    const real_t p = R(0.6666666666666666) + (z * (R(0.40000000000006264) + (z * (R(0.2857142856908017)
        + (z * (R(0.22222222647659087) + (z * (R(0.18181775596285038) + (z * (R(0.15387093794525235)
        + (z * (R(0.1325004937539979) + (z * R(0.13251956836180598))))))))))))));
    const real_t high = R(0.6931471804855391);
    const real_t low = R(7.440617110012397e-11);
#endif
    const real_t half = R(0.5) * (f * f);
    const real_t result = (n * high) + (f - (half - ((s * (half + (z * p))) + (n * low))));
    return (x > R(0.0)) ? result : ((x - x) / R(0.0));
}

/*@ pow : exp log */
/* x^y for x > 0 (0 at x = 0, NaN below); relative error <= (2 + |y log x|) ulp. */
static inline real_t own_pow(real_t x, real_t y)
{
    return (x == R(0.0)) ? R(0.0) : own_exp(y * own_log(x));
}

/*@ atan2 : abs */
/* Angle of (x, y) in [-pi, pi], 0 at the origin; <= 3 ulp. */
static inline real_t own_atan2(real_t y, real_t x)
{
    const real_t ax = own_abs(x);
    const real_t ay = own_abs(y);
    const bool steep = ay > ax;
    const real_t high = steep ? ay : ax;
    const real_t low = steep ? ax : ay;
    const bool wide = low > (R(0.41421356237309503) * high);
    const real_t difference = low - high;
    const real_t sum = low + high;
    const real_t top = wide ? difference : low;
    const real_t bottom = wide ? sum : high;
    const real_t t = top / ((bottom > R(0.0)) ? bottom : R(1.0));
    const real_t z = t * t;
#if REAL_IS_FLOAT
    const real_t p = R(-0.33333315464494623) + (z * (R(0.19998486722411696)
        + (z * (R(-0.14243793818444325) + (z * (R(0.1059557101128635) + (z * R(-0.06082305286926443))))))));
#else
    const real_t p = R(-0.333333333333332) + (z * (R(0.19999999999953874) + (z * (R(-0.14285714280226308)
        + (z * (R(0.11111110784977753) + (z * (R(-0.09090897801800647) + (z * (R(0.07692060999990159)
        + (z * (R(-0.06663112924920915) + (z * (R(0.05847953184837864)
        + (z * (R(-0.05039588276160153) + (z * (R(0.03807163972116166)
        + (z * R(-0.017914812366640904))))))))))))))))))));
#endif
    const real_t small = (wide ? R(0.7853981633974483) : R(0.0)) + (t + ((t * z) * p));
    const real_t first = steep ? (R(1.5707963267948966) - small) : small;
    const real_t half = (x < R(0.0)) ? (R(3.141592653589793) - first) : first;
    return (y < R(0.0)) ? -half : half;
}

/*@ atan : atan2 */
static inline real_t own_atan(real_t x)
{
    return own_atan2(x, R(1.0));
}

/*@ asin : atan2 sqrt */
static inline real_t own_asin(real_t x)
{
    return own_atan2(x, own_sqrt((R(1.0) - x) * (R(1.0) + x)));
}

/*@ acos : atan2 sqrt */
static inline real_t own_acos(real_t x)
{
    return own_atan2(own_sqrt((R(1.0) - x) * (R(1.0) + x)), x);
}

/*@ hypot : sqrt */
static inline real_t own_hypot(real_t x, real_t y)
{
    return own_sqrt((x * x) + (y * y));
}

/*@ floor : abs round */
/* Exact for |x| < 2^22 (float), 2^51 (double); above, x itself. */
static inline real_t own_floor(real_t x)
{
    const real_t nearest = (x + ROUNDER) - ROUNDER;
    const real_t below = (nearest > x) ? (nearest - R(1.0)) : nearest;
    return (own_abs(x) < (ROUNDER * R(0.25))) ? below : x;
}

/*@ ceil : floor */
static inline real_t own_ceil(real_t x)
{
    return -own_floor(-x);
}

/*@ fmod : floor */
/* x - y trunc(x / y) for |x / y| < 2^22 (float), 2^51 (double), sign of x; error <= |x| ulp. */
static inline real_t own_fmod(real_t x, real_t y)
{
    const real_t ax = own_abs(x);
    const real_t ay = own_abs(y);
    const real_t r = ax - (ay * own_floor(ax / ay));
    const real_t above = r + ay;
    const real_t high = (r < R(0.0)) ? above : r;
    const real_t below = high - ay;
    const real_t low = (high >= ay) ? below : high;
    return (x < R(0.0)) ? -low : low;
}

/*@ remainder : round */
static inline real_t own_remainder(real_t x, real_t y)
{
    return x - (y * (((x / y) + ROUNDER) - ROUNDER));
}

/*@ copysign : abs */
/* |x| with the sign of y; the negative zero counts as positive. */
static inline real_t own_copysign(real_t x, real_t y)
{
    const real_t size = own_abs(x);
    return (y < R(0.0)) ? -size : size;
}

/*@ sign */
static inline real_t own_sign(real_t x)
{
    return (x > R(0.0)) ? R(1.0) : ((x < R(0.0)) ? R(-1.0) : x);
}

/*@ fmin */
static inline real_t own_fmin(real_t x, real_t y)
{
    return (y < x) ? y : x;
}

/*@ fmax */
static inline real_t own_fmax(real_t x, real_t y)
{
    return (y > x) ? y : x;
}

/*@ clip */
static inline real_t own_clip(real_t x, real_t low, real_t high)
{
    return (x < low) ? low : ((x > high) ? high : x);
}

/*@ limit : abs */
/* x cut at a magnitude >= 0; x / |x| is exactly 1 or -1. */
static inline real_t own_limit(real_t x, real_t magnitude)
{
    const real_t size = own_abs(x);
    return (size <= magnitude) ? x : (magnitude * (x / size));
}

/*@ pattern : bit_types */
/* The bit pattern of a real in memory, and the same as a number with a sign: reals that are read as integers need no
   register of the floating-point unit. In single precision alone; in double a comparison is as good. */
#if REAL_IS_FLOAT
static inline bits_t pattern_at(const real_t *x)
{
    bits_t bits;
    (void)memcpy((unsigned char *)&bits, (const unsigned char *)x, sizeof(bits));
    return bits;
}

static inline signed_bits_t signed_pattern_at(const real_t *x)
{
    signed_bits_t bits;
    (void)memcpy((unsigned char *)&bits, (const unsigned char *)x, sizeof(bits));
    return bits;
}
#endif

/*@ within_magnitude : pattern */
/* |x| <= magnitude, false for what is no number; magnitude >= 0. */
#if REAL_IS_FLOAT
static inline bool own_within_magnitude(const real_t *x, const real_t *magnitude)
{
    return (pattern_at(x) << 1) <= (pattern_at(magnitude) << 1);
}
#endif

/*@ within : pattern */
/* low <= x <= high, false for what is no number; low < 0 < high. The patterns of positive numbers, read as integers
   with a sign, and of negative ones, read without, are ordered like the numbers. */
#if REAL_IS_FLOAT
static inline bool own_within(const real_t *x, const real_t *low, const real_t *high)
{
    return (pattern_at(x) <= pattern_at(low)) && (signed_pattern_at(x) <= signed_pattern_at(high));
}
#endif
