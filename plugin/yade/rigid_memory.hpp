#pragma once
// All that rigid blocks remember from one step to the next.

#include "number_archive.hpp"
#include "rigid_coordinates.hpp"
#include <boost/serialization/level.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/tracking.hpp>
#include <map>
#include <memory>
#include <stdexcept>

namespace yade {

/// The row of numbers begins with that of its layout, to be changed with any list of members, and that of the scene's dimensions.
constexpr Real layout = -19;

/// Lets `read` read a row. Throws std::runtime_error if another version has written it.
template <class Read>
void readMemory(const Read& read)
{
	try {
		read();
	} catch (const std::exception&) {
		throw std::runtime_error("MoreauJeanIntegrator cannot go on with this simulation: it was saved by another version of yade-masonry. "
		                         "Go on with that version, or build the scene anew.");
	}
}

/// Blocks by their ids, pairs by the numbers of their blocks.
template <class K>
struct Remembered {
	vector<int> ids;
	vector<Seat<K>> seats;
	vector<masonry::RigidBody<K>> bodies;
	vector<vector<typename K::Vector>> shapes; // vertices of the different ones, part by part
	vector<int> shapeOf;                       // numbers of the bodies' shapes
	vector<masonry::ContactPair<K>> pairs;
	vector<masonry::Tie<K>> ties;
	vector<masonry::MortarJoint<K>> mortar;

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(ids, seats, bodies, shapes, shapeOf, pairs, ties, mortar);
	}

	void takeShapes()
	{
		std::map<const masonry::Solid<typename K::Shape>*, int> numbers;
		shapes.clear();
		shapeOf.clear();
		for (const auto& body : bodies) {
			const auto [number, isNew] = numbers.emplace(body.shape.get(), int(shapes.size()));
			if (isNew)
				shapes.push_back(body.shape->vertices());
			shapeOf.push_back(number->second);
		}
	}
	bool hasShape(int body, const masonry::Solid<typename K::Shape>& shape) const
	{
		return shapes.at(shapeOf.at(body)) == shape.vertices();
	}
};

/// Told once in a run.
struct RigidWarnings {
	bool bases = false, place = false, motion = false;
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
