#pragma once
// The mortar of a joint as an attribute: the bond while it runs, numbers in a file.

#include "dynamics/compliant/mortar_bond.hpp"
#include "number_archive.hpp"
#include <boost/serialization/level.hpp>
#include <boost/serialization/nvp.hpp>
#include <boost/serialization/tracking.hpp>
#include <boost/serialization/vector.hpp>
#include <stdexcept>

namespace yade {

/// The numbers of a bond begin with that of their layout, to be changed with any list of members.
constexpr Real bondLayout = -1;

struct BondMemory {
	std::shared_ptr<masonry::MortarBond> bond;

	template <class Archive>
	void serialize(Archive& archive, unsigned)
	{
		vector<Real> values;
		if constexpr (Archive::is_saving::value) {
			masonry::NumberWriter writer;
			Real first = bondLayout;
			if (bond)
				writer(first, *bond);
			values = writer.numbers;
		}
		archive& boost::serialization::make_nvp("values", values);
		if constexpr (Archive::is_loading::value)
			read(values);
	}

private:
	void read(const vector<Real>& values)
	{
		bond.reset();
		if (values.empty())
			return;
		bond = std::make_shared<masonry::MortarBond>();
		masonry::NumberReader reader(values);
		try {
			Real first = 0;
			reader(first, *bond);
			if (first != bondLayout || !reader.isAtEnd())
				throw std::out_of_range("layout");
		} catch (const std::exception&) {
			throw std::runtime_error("The mortar of this simulation was saved by another version of yade-masonry: build the scene anew.");
		}
	}
};

} // namespace yade

BOOST_CLASS_IMPLEMENTATION(yade::BondMemory, boost::serialization::object_serializable)
BOOST_CLASS_TRACKING(yade::BondMemory, boost::serialization::track_never)
