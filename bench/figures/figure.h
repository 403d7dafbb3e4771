#pragma once

#include <span>
#include <string>
#include <vector>

#include "figures/claim.h"
#include "mallow/vec3.h"

namespace mallow::bench {

/// A scene that a figure needs.
struct Take {
  std::string name;                         ///< "alpha 0.7"
  std::string scene;                        ///< a file below data/scenes
  std::vector<std::string> overrides = {};  ///< as read_scene() takes them
};

/// What is measured in every frame.
struct Quantity {
  std::string key;    ///< "spread"
  std::string label;  ///< of the plot's axis, with its unit
};

/// A frame as it is measured. Positions are in id order [m].
struct FrameView {
  std::span<const Vec3> start;  ///< frame 0
  std::span<const Vec3> now;
  double spacing;         ///< h of the sampled body [m]
  double support_radius;  ///< σ [m]
  int threads;
};

/// A figure of the paper: what runs, what is measured, and what is claimed of it.
struct Figure {
  std::string name;          ///< "fig5a", as the command line has it
  std::string title;         ///< "Fig. 5(a): Moai"
  std::vector<int> moments;  ///< frames of the pictures
  std::vector<Quantity> quantities;
  /// small: the same scenes with fewer particles, as few as still show what is claimed.
  std::vector<Take> (*takes)(bool small);
  /// The values of the quantities, in their order.
  std::vector<double> (*measure)(const FrameView& frame);
  /// A pure function of what was measured of the takes, in their order.
  std::vector<Claim> (*judge)(std::span<const Recording> recordings);
};

Figure fig2();
Figure fig3();
Figure fig5a();
Figure fig5b();
Figure fig5c();
Figure fig5d();

/// All of them, in the paper's order.
std::vector<Figure> figures();

}  // namespace mallow::bench
