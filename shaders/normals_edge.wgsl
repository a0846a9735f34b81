/// A corner of a light: its direction w, the image A^-1 (wo + w), the unit vector c along the image, and the image's
/// length.
struct NormalsCorner {
    w: vec3<f32>,
    image: vec3<f32>,
    c: vec3<f32>,
    length: f32,
}

fn normals_corner(view: NormalsView, v: vec3<f32>) -> NormalsCorner {
    let w = v * normals_per_length(v);
    let image = w * vec3(view.per_alpha, 1.0) + view.image;
    let length2 = image.x * image.x + (image.y * image.y + (image.z * image.z + 1e-30));
    let per_length = inverseSqrt(length2);
    return NormalsCorner(w, image, image * per_length, length2 * per_length);
}

/// The image of an edge by four arcs: the integral of c x dc along it, added to an earlier one; the point halfway between
/// both ends; and the points where the arcs of each half meet.
struct NormalsEdge {
    flux: vec3<f32>,
    middle: vec3<f32>,
    q: vec3<f32>,
    r: vec3<f32>,
}

/// The image is the conic a + 2 t b + t^2 c.
fn normals_edge(view: NormalsView, flux: vec3<f32>, begin: NormalsCorner, end: NormalsCorner) -> NormalsEdge {
    let a = begin.c;
    let c = end.c;
    let sum = begin.w + end.w;
    let y = sum.x * sum.x + (sum.y * sum.y + (sum.z * sum.z + 1e-12));
    let image = begin.image + end.image + (0.5 * y - 2.0) * view.image;
    let b = image * inverseSqrt(y * (begin.length * end.length));
    // Split the conic at the point equally far from both ends, if the ends differ.
    let apart = a - c;
    let bend = 2.0 * dot(b, apart) / (apart.x * apart.x + (apart.y * apart.y + (apart.z * apart.z + 1e-8)));
    let t = bend + sqrt(bend * bend + 1.0);
    let left = a + t * b;
    let right = b + t * c;
    let middle = left + t * right;
    let per_length = normals_per_length(middle);
    let n = per_length * middle;
    // The arcs of each half meet a little outside the conic, so that they enclose its area.
    let root = sqrt(per_length);
    let least = 3.4 * root;
    let more = 0.6 * per_length * root;
    let beyond_left = a + n + (least + more * dot(left, left)) * left;
    let beyond_right = c + n + (least + more * dot(right, right)) * right;
    let q = beyond_left * normals_per_length(beyond_left);
    let r = beyond_right * normals_per_length(beyond_right);
    return NormalsEdge(normals_arcs(normals_arcs(flux, a, q, n), n, r, c), n, q, r);
}
