// The light's way through the cornea (iris paper, eq. 15): for each beam, over the iris on two planes of side x side
// points, the direction that stands for its lights' (x, y; z in down), the irradiance of a plane that faces it, and where on the
// cornea it came in (1: at the limbus); lib/draw/eye/march/beam.c and lib/optics/lightpath/lane.h. A tile a beam and plane.
uniform vec4 light_dir[DIRECTIONS];   // towards each light, and its share in its beam
uniform int first[TILES + 1];         // of each beam's lights; the last beam is the way to the camera: its light has no direction
uniform vec3 origin;                  // the camera
uniform int side;
uniform vec2 limbus;
uniform float path_bend;
layout(location = 0) out vec4 way;
layout(location = 1) out float down;

// Where the ray from P in direction q leaves the surface.
vec3 leave(vec3 P, vec3 q)
{
	float s = cornea_R - cornea_p * P.z;
	float A = dot(q.xy, q.xy) + cornea_p * q.z * q.z, B = dot(P.xy, q.xy) - s * q.z;
	float C = dot(P.xy, P.xy) - P.z * (cornea_R + s);
	return P - q * (C / (B + sqrt(max(B * B - A * C, 0.0))));
}

// Start in closed form: out along the light bent towards the axis, refracted there, out again.
vec2 start(vec3 P, vec3 w)
{
	vec3 K = leave(P, w - vec3(0.0, 0.0, path_bend * sqrt(cornea_n * cornea_n - 1.0)));
	vec3 G = vec3(K.xy, cornea_p * K.z - cornea_R);
	float a = dot(w, G), g2 = dot(G, G), f = (sqrt(a * a + (cornea_n * cornea_n - 1.0) * g2) - a) / g2;
	K = leave(P, w + f * G);
	return K.xy / (2.0 * cornea_R - cornea_p * K.z);
}

// Fermat: gradient and Hessian of n |KP| - w K in the chart K = R tau (x, y, rho^2), tau = 2 / (1 + p rho^2).
void curve(vec2 x, vec3 P, vec3 w, out vec2 g, out vec3 H, out float tau)
{
	float p = cornea_p, n = cornea_n, rho2 = dot(x, x);
	tau = 2.0 / (1.0 + p * rho2);
	float t = cornea_R * tau;
	vec3 v = vec3(t * x, t * rho2) - P;
	float inv = 1.0 / length(v), f = n * inv;
	v *= inv;
	vec3 d = n * v - w;
	float gm = tau * (d.z - p * dot(x, d.xy)), vm = tau * (v.z - p * dot(x, v.xy));
	vec2 va = v.xy + x * vm;
	float bend = f + gm * (1.0 + p * rho2) / (2.0 * cornea_R), m2 = f * tau * (tau * (1.0 + p * p * rho2) - 2.0 * p);
	g = d.xy + x * gm;
	H = vec3(bend + m2 * x.x * x.x - f * va.x * va.x, m2 * x.x * x.y - f * va.x * va.y,
	         bend + m2 * x.y * x.y - f * va.y * va.y);
}

// T cos i |dK/dP| / N_z.
float caustic(vec2 x, vec3 P, vec3 w, vec3 H, float tau)
{
	float p = cornea_p, t = cornea_R * tau, rho2 = dot(x, x);
	vec3 v = vec3(t * x, t * rho2) - P;
	float f = cornea_n / length(v);
	v = normalize(v);
	float vm = tau * (v.z - p * dot(x, v.xy));
	vec2 va = v.xy + x * vm, m = -tau * p * x;
	float m11 = 1.0 + x.x * m.x - va.x * v.x, m12 = x.x * m.y - va.x * v.y;
	float m21 = x.y * m.x - va.y * v.x, m22 = 1.0 + x.y * m.y - va.y * v.y;
	float moved = f * f * (m11 * m22 - m12 * m21) / (H.x * H.z - H.y * H.y);
	float gz = cornea_R - p * t * rho2, len = sqrt(t * t * rho2 + gz * gz);
	float cos_i = (t * dot(w.xy, x) - w.z * gz) / len;
	float area = (1.0 + dot(x, m)) * len / gz;
	return cos_i > 0.0 ? (1.0 - mirror_share(cos_i, cornea_n)) * cos_i * abs(moved) * area : 0.0;
}

vec3 surface(vec2 x)
{
	float rho2 = dot(x, x);
	return 2.0 * cornea_R / (1.0 + cornea_p * rho2) * vec3(x, rho2);
}

// n |aP| - n |bP| - w (b - a) without cancellation.
float longer(vec3 a, vec3 b, vec3 P, vec3 w)
{
	vec3 way = b - a, both = a + b - 2.0 * P;
	return cornea_n * dot(way, both) / (length(a - P) + length(b - P)) - dot(w, way);
}

// Newton's steps, kept downhill (lib/optics/lightpath/lightpath.c); false where they do not end in a minimum.
bool descend(inout vec2 x, vec3 P, vec3 w)
{
	for (int i = 0; i < 40; i++) {
		vec2 g;
		vec3 H;
		float tau;
		curve(x, P, w, g, H, tau);
		float mean = 0.5 * (H.x + H.z), half_ = length(vec2(0.5 * (H.x - H.z), H.y)), least = mean - half_;
		float lift = least < 1e-5 * half_ ? 1e-2 * (abs(mean) + half_) - least : 0.0, a = H.x + lift, c = H.z + lift;
		vec2 move = vec2(H.y * g.y - c * g.x, H.y * g.x - a * g.y) / (a * c - H.y * H.y);
		float size = length(move), slope = dot(move, g), k = min(1.0, 3.0 / size), per = 1.0 / (cornea_R * tau);
		if (!(size < 1e6))
			return false;
		// Below a few micrometres float's lengths no longer tell the points apart; Newton's step is right there.
		vec3 from = surface(x);
		for (int j = 0; j < 14 && size > 2e-3; j++) {
			if (longer(from, surface(x + k * per * move), P, w) <= 1e-4 * k * slope)
				break;
			k *= 0.4;
		}
		x += k * per * move;
		if (size < 2e-5)
			return true;
		if (i > 30 && size < 2e-3)
			return true;
	}
	return false;
}

// One light at P: direction, and power in w.
vec4 arrives(vec3 P, vec3 w, out float rho)
{
	vec2 x = start(P, w), g;
	vec3 H;
	float tau;
	bool found = descend(x, P, w);
	curve(x, P, w, g, H, tau);
	vec3 K = found ? surface(x) : P + w, l = normalize(K - P);
	float gain = found ? caustic(x, P, w, H, tau) : 0.0;
	rho = min(length(K.xy / limbus), 4.0);
	return vec4(l, gain / max(-l.z, 0.05));
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy), tile = at / side, cell = at - tile * side;
	vec2 place = vec2(cell) / float(side - 1) * 2.0 * extent - extent;
	float r = length(place), most = 1.04 * limbus.x, rho, all = 0.0, in_at = 0.0;
	vec3 P = vec3(place * min(1.0, most / max(r, 1e-6)), tile.x == 0 ? beam_z.x : beam_z.y), sum = vec3(0.0), down_sum = vec3(0.0);
	for (int i = first[tile.y]; i < first[tile.y + 1]; i++) {
		vec3 w = light_dir[i].xyz;
		if (w == vec3(0.0))
			w = normalize(origin - surface(start(P, normalize(origin - P))));
		vec4 l = arrives(P, w, rho);
		float power = light_dir[i].w * (l.w + 1e-9);  // where none comes, a direction still
		all += power;
		sum += power * l.xyz;
		down_sum += power * -l.z * l.xyz;
		in_at += power * rho;
	}
	// The one direction in which tissue is as bright as under all of them: beam_direction() of lib/draw/eye/march/beam.c.
	vec3 mean = sum / all, with_cosine = down_sum / all + mean * mean.z;
	float m = max(-mean.z, 0.05), part = 1.0 / (m + 1.0);
	vec3 d = mean * (1.0 - part * with_cosine.z / m) - 2.0 * part * with_cosine;
	way = vec4(d.xy, all, in_at / all);
	down = d.z;
}
