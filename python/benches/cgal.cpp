// Curvature by CGAL, version 6 or later, for curvature.py.
//
//     g++ -O2 -I/usr/include/eigen3 cgal.cpp -o cgal -lgmp -lmpfr
//     cgal METHOD < mesh > curvatures
//
// METHOD is "corrected", interpolated_corrected_curvatures, or a number of rings for
// Monge_via_jet_fitting: jets of degree 2 through the vertices of these rings, or for 0 of the
// fewest whole rings that have six vertices with the centre, the default of CGAL's example
// Mesh_estimation. The mesh is "vertices faces", a line for each position and one for each
// triangle. Prints the version of CGAL and for each vertex H in 1/length and K in 1/length²,
// positive on a sphere whose faces are counter-clockwise seen from outside; "nan nan" where a mesh
// has too few vertices.

#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Polygon_mesh_processing/interpolated_corrected_curvatures.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Vector = Kernel::Vector_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Fit = CGAL::Monge_via_jet_fitting<Kernel>;

constexpr std::size_t DEGREE = 2, LEAST = (DEGREE + 1) * (DEGREE + 2) / 2;

static void corrected(const std::vector<Point>& points,
                      const std::vector<std::array<std::size_t, 3>>& faces) {
  Mesh mesh;
  for (const Point& p : points) mesh.add_vertex(p);
  for (const auto& f : faces)
    mesh.add_face(Mesh::Vertex_index(f[0]), Mesh::Vertex_index(f[1]), Mesh::Vertex_index(f[2]));
  auto mean = mesh.add_property_map<Mesh::Vertex_index, double>("v:mean", 0).first;
  auto gaussian = mesh.add_property_map<Mesh::Vertex_index, double>("v:gaussian", 0).first;
  CGAL::Polygon_mesh_processing::interpolated_corrected_curvatures(
      mesh,
      CGAL::parameters::vertex_mean_curvature_map(mean).vertex_Gaussian_curvature_map(gaussian));
  for (Mesh::Vertex_index v : mesh.vertices()) std::printf("%.17g %.17g\n", mean[v], gaussian[v]);
}

static void jets(const std::vector<Point>& points,
                 const std::vector<std::array<std::size_t, 3>>& faces, int rings) {
  std::vector<std::set<std::size_t>> neighbours(points.size());
  std::vector<Vector> normals(points.size(), Vector(0, 0, 0));
  for (const auto& f : faces) {
    Vector normal = CGAL::cross_product(points[f[1]] - points[f[0]], points[f[2]] - points[f[0]]);
    normal = normal / std::sqrt(normal.squared_length());
    for (int k = 0; k < 3; ++k) {
      normals[f[k]] = normals[f[k]] + normal;
      neighbours[f[k]].insert({f[(k + 1) % 3], f[(k + 2) % 3]});
    }
  }
  for (std::size_t v = 0; v < points.size(); ++v) {
    std::vector<std::size_t> near{v};
    std::set<std::size_t> seen{v};
    std::size_t begin = 0;
    for (int ring = 1; rings ? ring <= rings : near.size() < LEAST; ++ring) {
      const std::size_t end = near.size();
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t w : neighbours[near[i]])
          if (seen.insert(w).second) near.push_back(w);
      if (near.size() == end) break;
      begin = end;
    }
    if (near.size() < LEAST) {
      std::puts("nan nan");
      continue;
    }
    std::vector<Point> sample;
    for (std::size_t w : near) sample.push_back(points[w]);
    Fit fit;
    Fit::Monge_form form = fit(sample.begin(), sample.end(), DEGREE, DEGREE);
    form.comply_wrt_given_normal(normals[v]);
    // Theirs are positive where the surface bends towards its normal.
    const double a = -form.principal_curvatures(0), b = -form.principal_curvatures(1);
    std::printf("%.17g %.17g\n", (a + b) / 2, a * b);
  }
}

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: cgal corrected|RINGS < mesh\n", stderr), 2;
  std::size_t n = 0, m = 0;
  std::cin >> n >> m;
  std::vector<Point> points(n);
  for (Point& p : points) std::cin >> p;
  std::vector<std::array<std::size_t, 3>> faces(m);
  for (std::size_t i = 0; i < m; ++i) {
    auto& f = faces[i];
    std::cin >> f[0] >> f[1] >> f[2];
    if (!std::cin || f[0] >= n || f[1] >= n || f[2] >= n)
      return std::fprintf(stderr, "triangle %zu is incomplete or has no such vertex\n", i), 1;
  }
  std::puts(CGAL_VERSION_STR);
  if (std::string(argv[1]) == "corrected")
    corrected(points, faces);
  else
    jets(points, faces, std::atoi(argv[1]));
}
