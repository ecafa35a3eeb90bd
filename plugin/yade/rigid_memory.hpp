#pragma once
// All that rigid blocks remember from one step to the next, as a row of numbers that is saved with the simulation.

#include "rigid_coordinates.hpp"
#include <boost/serialization/level.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/tracking.hpp>
#include <memory>
#include <stdexcept>

namespace yade {

/// The row begins with the number of its layout and model, to be changed with any list of members. Rows of old have none: they begin with
/// how many blocks there are.
constexpr Real layout = -9;

/// Numbers, enumerations and matrices go into the row, or come out of it, by the same list of members.
struct Packer {
	explicit Packer(int dimension) : values {layout, Real(dimension)} {}
	vector<Real> values;
	template <class T>
	void operator()(const T& value)
	{
		if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
			values.push_back(Real(value));
		else
			for (int i = 0; i < value.size(); ++i)
				values.push_back(value(i));
	}
};

class Unpacker {
public:
	Unpacker(const vector<Real>& row, int dimension) : values(row)
	{
		if (take() != layout)
			refuse();
		if (take() != dimension)
			throw std::runtime_error(
			    "MoreauJeanIntegrator.remembered is of a run in the plane and this one is in space, or the other way round.");
	}
	template <class T>
	void operator()(T& value)
	{
		if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
			value = T(take());
		else
			for (int i = 0; i < value.size(); ++i)
				value(i) = take();
	}
	void end() const
	{
		if (next != values.size())
			refuse();
	}

	[[noreturn]] static void refuse()
	{
		throw std::runtime_error("MoreauJeanIntegrator cannot go on with this simulation: it was saved by another version of yade-masonry. "
		                         "Go on with that version, or build the scene anew.");
	}

private:
	Real take()
	{
		if (next == values.size())
			refuse();
		return values[next++];
	}

	const vector<Real>& values;
	size_t next = 0;
};

namespace memory {
using namespace masonry::rigid;

template <class Flow>
void pass(Flow& f, PlaneFeature& p)
{
	f(p.vertexBody), f(p.vertex), f(p.face);
}
template <class Flow>
void pass(Flow& f, SpaceFeature& p)
{
	f(p.kind), f(p.first), f(p.second);
}
template <class Flow>
void pass(Flow& f, PlaneMemory& m)
{
	f(m.reference), f(m.face1), f(m.face2);
	for (PlaneFeature& feature : m.features)
		pass(f, feature);
}
template <class Flow>
void pass(Flow& f, masonry::PatchFeature& m)
{
	f(m.kind), f(m.feature1), f(m.feature2), f(m.vertices);
}
template <class Flow>
void pass(Flow& f, Seat<Plane>& s)
{
	f(s.across), f(s.upright), f(s.lengthwise), f(s.depth), f(s.reference.coeffs());
}
template <class Flow>
void pass(Flow&, Seat<Space>&)
{
}

// Masses belong to the scene, and so do sizes, but for knowing whether they have changed; and laws, but for those that no interaction shows
// yet; gaps are measured anew. By their places
// points are known again that go to other features.
template <class Flow, class K>
void pass(Flow& f, RigidBody<K>& b)
{
	f(b.halfSize), passPose(f, b.pose), f(b.velocity), f(b.increment), f(b.fresh), f(b.prescribed), f(b.drive), f(b.origin);
}
template <class Flow, class K>
void pass(Flow& f, ContactPair<K>& p)
{
	f(p.body1), f(p.body2), f(p.face1), f(p.face2), f(p.friction), f(p.restitution), f(p.beside), f(p.size);
	if (!(p.size >= 0 && p.size <= K::maxPoints))
		Unpacker::refuse();
	pass(f, p.memory);
	for (int i = 0; i < p.size; ++i) {
		ContactPoint<K>& point = p.points[i];
		pass(f, point.feature);
		f(point.closed), f(point.sliding), f(point.force), f(point.frame.position);
	}
}
} // namespace memory

/// Blocks by their ids, pairs by the numbers of their blocks.
template <class K>
struct Remembered {
	vector<int> ids;
	vector<Seat<K>> seats;
	vector<masonry::rigid::RigidBody<K>> bodies;
	vector<masonry::rigid::ContactPair<K>> pairs;

	template <class Flow>
	void pass(Flow& f)
	{
		size_t blocks = ids.size(), count = pairs.size();
		f(blocks), f(count);
		ids.resize(blocks);
		seats.resize(blocks);
		bodies.resize(blocks);
		pairs.resize(count);
		for (size_t b = 0; b < blocks; ++b) {
			f(ids[b]);
			memory::pass(f, seats[b]);
			memory::pass(f, bodies[b]);
		}
		for (auto& pair : pairs)
			memory::pass(f, pair);
	}
};

/// The blocks of a run in the core's form.
struct RigidRun {
	virtual ~RigidRun() = default;
	virtual vector<Real> pack() = 0;
	/// Its scene is the one that YADE runs.
	virtual bool isPresent() const = 0;
};

/// Attribute of the integrator: the blocks while it runs, numbers in a file.
struct RigidMemory {
	std::shared_ptr<RigidRun> run;
	vector<Real> values;

	template <class Archive>
	void serialize(Archive& archive, unsigned)
	{
		if constexpr (Archive::is_saving::value) {
			if (run)
				values = run->isPresent() ? run->pack() : vector<Real>();
		} else {
			run.reset();
		}
		archive& boost::serialization::make_nvp("values", values);
	}
};

} // namespace yade

BOOST_CLASS_IMPLEMENTATION(yade::RigidMemory, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(yade::RigidMemory, boost::serialization::track_never)
