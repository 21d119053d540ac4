#include "io/models/rib_shaders.hpp"

namespace hybrid::io {

const char* const kProjectorShader =
    R"SL(/* One photograph as a slide projector with its lens. Shader space is the camera's own: x right, y down, z
   forward, in metres. What the photograph does not see gets no light: points behind it, outside its picture,
   or farther than its depth picture says (by more than `bias` metres, more at grazing angles).

   Lens (`lens`): 0 polynomial or rational: with s = x^2 + y^2 of x, y = X/Z, Y/Z
     q = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
     x' = x q + 2 p1 x y + p2 (s + 2 x^2),  y' = y q + 2 p2 x y + p1 (s + 2 y^2)
   1 fisheye: a = atan(sqrt s), q = a (1 + k1 a^2 + k2 a^4 + k3 a^6 + k4 a^8) / sqrt s
   2 spherical, 3 cylindrical panorama.
   The slide is sRGB; light is linear. `photo_seen` tells the surface how much of the photograph counts: 0
   unseen, up to 1, less within `feather` pixels of its border. */
float linear_light(float value) {
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

light hybrid_projector(string slide = ""; string depth = "";
                       float lens = 0, width = 1, height = 1, fx = 1, fy = 1, cx = 0, cy = 0;
                       float k1 = 0, k2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0, p1 = 0, p2 = 0;
                       float largest_s = 1e30, feather = 32, bias = 0.02;
                       string __category = "hybrid";
                       output varying float photo_seen = 0;)
{
    point q = transform("shader", Ps);
    float X = xcomp(q), Y = ycomp(q), Z = zcomp(q);
    float column = -1, row = -1, far = Z;

    illuminate(point "shader" (0, 0, 0)) {
        Cl = 0;
        photo_seen = 0;
        if (lens >= 2) {
            float level = sqrt(X * X + Z * Z);
            far = length(vector(X, Y, Z));
            column = fx * atan(X, Z) + cx;
            row = cy + fy * (lens < 3 ? atan(Y, level) : Y / max(level, 1e-9));
            float turn = 2 * PI * fx;
            if (column < 0) column += turn;
            if (column > width) column -= turn;
        } else if (Z > 0) {
            float x = X / Z, y = Y / Z;
            float s = x * x + y * y;
            if (s < largest_s) {
                if (lens < 1) {
                    float scale = (1 + s * (k1 + s * (k2 + s * k3))) / (1 + s * (k4 + s * (k5 + s * k6)));
                    column = fx * (x * scale + 2 * p1 * x * y + p2 * (s + 2 * x * x)) + cx;
                    row = fy * (y * scale + 2 * p2 * x * y + p1 * (s + 2 * y * y)) + cy;
                } else {
                    float a = atan(sqrt(s));
                    float b = a * a;
                    float scale = 1;
                    if (s > 0)
                        scale = a * (1 + b * (k1 + b * (k2 + b * (k3 + b * k4)))) / sqrt(s);
                    column = fx * x * scale + cx;
                    row = fy * y * scale + cy;
                }
            }
        }
        if (column >= 0 && row >= 0 && column < width && row < height) {
            float u = column / width, v = row / height;
            float seen = 1;
            if (depth != "") {
                float nearest = float texture(depth[0], u, v, "width", 0);
                /* Depth pictures are sampled at their pixels' centres: at grazing angles a pixel spans more. */
                if (far > nearest + bias + 2 * far / fx) seen = 0;
            }
            if (seen > 0) {
                float border = min(min(column, width - column), min(row, height - row));
                photo_seen = clamp(border / max(feather, 1e-6), 1e-6, 1);
                color encoded = color texture(slide, u, v);
                Cl = color(linear_light(comp(encoded, 0)), linear_light(comp(encoded, 1)),
                           linear_light(comp(encoded, 2)));
            }
        }
    }
}
)SL";

const char* const kBlendShader =
    R"SL(/* View-dependent blending of the photographs that see a point (Debevec et al. 1996): each weighs
   1 / (angle between its ray and the viewer's + one pixel), feathered to 0 at its border. One that meets the
   surface at no more than `grazing_deg` does not see it. Seen by none: red. */
surface hybrid_blend(float pixel_rad = 0.001, grazing_deg = 2;)
{
    normal front = faceforward(normalize(N), I);
    vector to_eye = -normalize(I);
    color sum = 0;
    float weights = 0;
    illuminance("hybrid", P, front, PI / 2 - radians(grazing_deg)) {
        float seen = 0;
        if (lightsource("photo_seen", seen) == 1 && seen > 0) {
            float angle = acos(clamp(normalize(L) . to_eye, -1, 1));
            float weight = seen / (angle + pixel_rad);
            sum += weight * Cl;
            weights += weight;
        }
    }
    Oi = 1;
    Ci = weights > 0 ? sum / weights : color(1, 0, 0);
}
)SL";

}  // namespace hybrid::io
