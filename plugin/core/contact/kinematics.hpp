#pragma once
// The plane and space: all that the rigid step must know of either. Everything else is written once, for both.
//
// Plane: coordinates (along, up); angles and moments counter-clockwise from `along` to `up`. Space: global axes.
// A velocity holds the linear part, then the spin; a force likewise the force, then the moment about the centre.
#include "contact/contact_patch.hpp"
#include "math.hpp"
#include "shape/convex_polygon.hpp"
#include "shape/convex_polyhedron.hpp"
#include <algorithm>
#include <array>
#include <cmath>

namespace masonry {

struct PlanePose {
	Vector2 position {Vector2::Zero()};
	double angle {0}, cosine {1}, sine {0}; // of the body axes against the global ones

	void setAngle(double value)
	{
		angle = value;
		cosine = std::cos(value);
		sine = std::sin(value);
	}
	void turn(double by)
	{
		constexpr double tiny = 1e-9; // its square is below the last digit
		if (std::abs(by) > tiny)
			return setAngle(angle + by);
		angle += by;
		const double before = cosine;
		cosine -= by * sine;
		sine += by * before;
	}
	// The same to round-off by series, without sine and cosine: for a pose that no other one follows from.
	void turnOnce(double by)
	{
		constexpr double small = 0.05; // the first terms left out are below 1e-17
		if (std::abs(by) > small)
			return setAngle(angle + by);
		const double x = by * by, s = by * (1 - x / 6 * (1 - x / 20 * (1 - x / 42))),
		             less = x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56)));
		const double before = cosine;
		angle += by;
		cosine -= less * cosine + s * sine;
		sine += s * before - less * sine;
	}
	Vector2 rotate(const Vector2& local) const { return {cosine * local.x() - sine * local.y(), sine * local.x() + cosine * local.y()}; }
	Vector2 rotateBack(const Vector2& global) const
	{
		return {cosine * global.x() + sine * global.y(), cosine * global.y() - sine * global.x()};
	}
	Vector2 toGlobal(const Vector2& local) const { return position + rotate(local); }
	Vector2 toLocal(const Vector2& global) const { return rotateBack(global - position); }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(position, angle, cosine, sine);
	}
};

// A pair of polygons in the plane remembers this from one search to the next.
struct PlaneMemory {
	int reference {0};          // body 1 or 2 whose face was the reference; 0: none
	int face1 {-1}, face2 {-1}; // faces in touch
	std::array<Feature, 2> features;

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(reference, face1, face2, features);
	}
};

// The place where two bodies meet at one contact point, and its axes, in rows: the normal from body 1 to body 2, then one or two tangents;
// they move with the body that has the face (edges: with body 1's edge). The gap's rate is the normal row of the relative velocity
// (body 2 minus body 1) at `position`, also while it is open. The tangent rows hold at position + grip.
template <class K>
struct ContactFrame {
	typename K::Vector position {K::Vector::Zero()};
	typename K::Vector grip {K::Vector::Zero()}; // to the friction point, along the tangents (grip.hpp)
	Eigen::Matrix<double, K::rows, K::dimension> axes {Eigen::Matrix<double, K::rows, K::dimension>::Zero()};
	double gap {0};
};

// The contact points of a pair of convex blocks. Those from number `places` on are second normals, at corners that meet corners
// (corner_normals.hpp).
template <class K>
struct FoundPoints {
	PerPoint<Feature, K::usualPoints> features;
	int places {0};
	PerPoint<int, K::usualPoints> corners; // of the second normals: the points whose places they share
	int face1 {-1}, face2 {-1};            // the faces that meet (edges: those nearest to the normal)

	int size() const { return int(features.size()); }
	bool has(const Feature& feature) const { return std::find(features.begin(), features.end(), feature) != features.end(); }
	int cornerOf(int secondNormal) const { return corners[secondNormal - places]; }

	// All points found so far have places of their own.
	void beginSecondNormals() { places = size(); }
	void addSecondNormal(const Feature& feature, int place)
	{
		if (has(feature))
			return;
		features.push_back(feature);
		corners.push_back(place);
	}
	void dropSecondNormal(int number)
	{
		features.erase(features.begin() + number);
		corners.erase(corners.begin() + (number - places));
	}
};

struct Plane {
	static constexpr int dimension = 2, spins = 1, dof = 3, rows = 2, usualPoints = 3;
	using Vector = Vector2;
	using Spin = Eigen::Matrix<double, 1, 1>;
	using Velocity = Eigen::Matrix<double, 3, 1>;
	using Inertia = Eigen::Matrix<double, 1, 1>; // kg m^2, about the centre
	using InverseInertia = Eigen::Matrix<double, 1, 1>;
	using Pose = PlanePose;
	using Shape = ConvexPolygon;
	using Memory = PlaneMemory;

	static Vector cross(const Spin& w, const Vector& r) { return {-w[0] * r.y(), w[0] * r.x()}; }
	static Spin moment(const Vector& r, const Vector& f) { return Spin(r.x() * f.y() - r.y() * f.x()); }
	static void advance(Pose& pose, const Velocity& velocity, double t)
	{
		pose.position += t * velocity.head<2>();
		pose.turn(t * velocity[2]);
	}
	static void advanceOnce(Pose& pose, const Velocity& velocity, double t) // a pose that no other one follows from
	{
		pose.position += t * velocity.head<2>();
		pose.turnOnce(t * velocity[2]);
	}
	static Spin angularMomentum(const Inertia& inertia, const Pose&, const Spin& w) { return inertia * w; }
	static InverseInertia inverseInertia(const Inertia& inertia, const Pose&) { return inertia.cwiseInverse(); }

	static ContactFrame<Plane> frame(const Feature&, const Shape& shape1, const Pose&, const Shape& shape2, const Pose&);
	// The vertices that meet a face at the ends of the two faces' overlap; of a corner that stands past the end of a face, only that
	// vertex. Points keep their features by the memory until another choice is clearly better (tolerance::contact). False, with
	// nothing found, when the polygons are farther apart than `margin` (m) or only meet corner beside corner (overlap below ::sliver).
	static bool findPoints(const Shape& shape1, const Pose&, const Shape& shape2, const Pose&, double margin, Memory&, FoundPoints<Plane>&);
	// The second normals of points that are corners on corners (corner_normals.hpp).
	static void addSecondNormals(const Shape& shape1, const Pose&, const Shape& shape2, const Pose&, FoundPoints<Plane>&);
};

struct Space {
	static constexpr int dimension = 3, spins = 3, dof = 6, rows = 3, usualPoints = 8;
	using Vector = Vector3;
	using Spin = Vector3;
	using Velocity = Eigen::Matrix<double, 6, 1>;
	using Inertia = Vector3;        // principal moments, kg m^2
	using InverseInertia = Matrix3; // global axes
	using Pose = masonry::Pose;
	using Shape = ConvexPolyhedron;
	using Memory = PatchFeature;

	static Vector cross(const Spin& w, const Vector& r) { return w.cross(r); }
	static Spin moment(const Vector& r, const Vector& f) { return r.cross(f); }
	static void advance(Pose& pose, const Velocity& velocity, double t); // orientation by the exponential of the spin
	static void advanceOnce(Pose& pose, const Velocity& velocity, double t) { advance(pose, velocity, t); }
	static Spin angularMomentum(const Inertia& inertia, const Pose& pose, const Spin& w)
	{
		return pose.orientation * inertia.cwiseProduct(pose.orientation.conjugate() * w);
	}
	static InverseInertia inverseInertia(const Inertia& inertia, const Pose& pose)
	{
		const Matrix3 axes = pose.orientation.toRotationMatrix();
		return axes * inertia.cwiseInverse().asDiagonal() * axes.transpose();
	}

	static ContactFrame<Space> frame(const Feature&, const Shape& shape1, const Pose&, const Shape& shape2, const Pose&);
	// The corners of the contact patch (contact/contact_patch.hpp), without the crossings of nearly parallel edges. False as in the plane.
	static bool findPoints(const Shape& shape1, const Pose&, const Shape& shape2, const Pose&, double margin, Memory&, FoundPoints<Space>&);
	// The second normals of vertices that are on edges (corner_normals.hpp).
	static void addSecondNormals(const Shape& shape1, const Pose&, const Shape& shape2, const Pose&, FoundPoints<Space>&);
};

} // namespace masonry
