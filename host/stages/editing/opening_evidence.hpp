#pragma once
#include "stages/editing/openings.hpp"

namespace hybrid::stages {

using Vec2f = Eigen::Vector2f;

// A sample as a face sees it: its foot on the face and its height over it.
struct FaceSample {
  float u, v, height_m;
  float area_m2;    // that it stands for, on its own surface; 0 for one without a plane
  float spacing_m;  // of samples on the face where its ray meets it
  std::uint16_t scan;
  bool parallel;  // its plane is nearly parallel to the face
};

// Samples on, near or behind one face, in a fixed order. `foot` is where a scan's scanner stands.
struct FaceSamples {
  std::vector<FaceSample> samples;
  std::vector<Vec2> scanner_foot;        // per scan
  std::vector<double> scanner_height_m;  // per scan
};

// World points of all scans, thinned to at most some million per scan.
struct EvidencePoint {
  Vec3f point;   // relative to `origin`
  Vec3f normal;  // of its supercluster, world; zero: none
  float area_m2;
  std::uint16_t scan;
};
// Successive points of a row of a scan and the cone that they lie in.
struct EvidenceRun {
  std::size_t first = 0, count = 0;  // of `points`
  Vec3f axis = Vec3f::Zero();        // from the scanner; zero: wider than half of all directions
  float cosine = 0, sine = 1;        // of the angle between it and the cone's side
  float far_m = 0;                   // the farthest point, from the scanner
};
struct EvidenceCloud {
  Vec3 origin;
  std::vector<EvidencePoint> points;
  std::vector<EvidenceRun> runs;       // of all points, in their order
  std::vector<std::size_t> first_run;  // per scan, and the end
  std::vector<Vec3> scanners;          // world
  std::vector<double> step_rad;        // per scan, of the thinned grid
};
EvidenceCloud gather_points(const PolygonModel& model, const std::vector<OpeningScan>& scans);

// Its time follows the samples in the directions of the face, not all samples: a model may have many faces.
FaceSamples samples_of_face(const EvidenceCloud& cloud, const FaceFrame& frame);

// Offset, spread and status ("as modelled" or "displaced", "unseen") of a face's surface.
void measure_surface(const FaceSamples& samples, const std::vector<Ring2>& rings, double displaced_m,
                     FaceEvidence& face);

// A ray or sample in the face's coordinates, classified with the surface's offset taken off.
struct EvidenceMark {
  Vec2f at;       // where the ray passes the face, or the sample's foot
  float depth_m;  // behind the surface, negative before it
  CellEvidence kind;
  Vec2f slope = Vec2f::Zero();  // of the ray behind the face: its way aside per depth
  // Behind the surface: through, or on a reveal.
  bool passes() const { return kind == CellEvidence::through || kind == CellEvidence::behind; }
};
std::vector<EvidenceMark> classify(const FaceSamples& samples, const FaceEvidence& face);

// Those in a ring's bounding box and so far around it.
std::vector<EvidenceMark> marks_near(const std::vector<EvidenceMark>& marks, const Ring2& ring,
                                     double margin_m);

}  // namespace hybrid::stages
