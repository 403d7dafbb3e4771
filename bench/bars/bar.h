#pragma once

/// A square bar that is held at one end and set swinging without any damping, beside the theory of thin
/// beams: whether a Young's modulus in pascals is what it says.
namespace mallow::bars {

struct Bar {
  double spacing = 0.01;  ///< h [m]
  int across = 6;         ///< particles along its width and height
  int along = 24;         ///< of its free length
  double alpha = 0;
  double modulus = 2e4;       ///< Y at alpha 0 [Pa]
  double density = 1000;      ///< [kg/m³]
  double time_step = 0.0015;  ///< Δt0 [s]
  double radius = 2.1;        ///< support radius, and that of the regions [h]
  int region_stride = 1;
  int threads = 1;

  double side() const { return across * spacing; }
  double length() const { return along * spacing; }
  double stiffness() const { return (1 - alpha) * modulus; }  ///< E [Pa]
};

/// Of the free end: how far it is from where it started in the mean of a period [m], and that period [s].
struct Swing {
  double rest = 0;
  double period = 0;
};

/// Sags under a load that bends it by a hundredth of its length.
Swing bend(const Bar& bar);
/// Hangs under a load along it that stretches it by a hundredth.
Swing stretch(const Bar& bar);
/// Twists to and fro without a load; rest is 0.
Swing twist(const Bar& bar);

/// The same by Euler-Bernoulli, with Poisson's ratio 0, and by Timoshenko, whose beams are sheared too: the
/// rest of bend() is a share 0.8 (side/length)² more. [model 2, section 3]
Swing theory_of_bend(const Bar& bar);
Swing theory_of_stretch(const Bar& bar);
Swing theory_of_twist(const Bar& bar);
double timoshenko_share(const Bar& bar);

}  // namespace mallow::bars
