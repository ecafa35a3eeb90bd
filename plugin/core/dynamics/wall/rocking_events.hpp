#pragma once
// Joints that rock and land: they get rows that give them the rocking restitution law (impact/rocking_restitution.hpp).
//
// A joint (joint_table.hpp) rocks when it is loaded at one place, its pivot, and open beside it. A
// step of length h brings a landing point from its gap to zero, and so takes the share
//
//     s = 1 - gap/(h u)          u: approach speed that the step would give without the landing
//
// of the impact; the rest comes at the instant after the step, when forces do nothing. Both are impacts of the same law, to the same
// target:
//
//     e.(w - w_carry) = before (1 - s + s C)  in the step,        e.(w - w_carry) = before C  after it
//
// so that bodies move in the step as they would with an impact at its instant within the step. `before` is that of the end of the step, as
// the last change of the velocities predicts it. All joints that land in a step do so together, with everything else in touch.
//
// The landing is that of the impact law (impact/landing.hpp), with the velocities that are predicted. Here w_carry is a part of the row,
// and so that of the supports as they move after the impact: with C = 0 the block stays in touch with both. Localised impacts keep
// e.(w_carry - w_support) from before the impact instead; both are the same on one support. Where the supports are two blocks of a wall,
// that difference changes in the impact as much as the spin does, and rows that keep it make energy. A spin below what gravity gives the
// block in a step lands with its natural restitution, since the step does not resolve it.
#include "dynamics/wall/admm_results.hpp"
#include "impact/rocking_restitution.hpp"
#include "joints/pivot.hpp"

namespace masonry::wall {

template <class K>
class RockingEvents {
public:
	// Before the solve of a step: the joints that rock. `change`: of the velocities, that the step is expected to bring. Returns the rows
	// of those that will land.
	std::vector<SpinRow<K>> find(const RigidSystem<K>& system, const ContactSet<K>& contacts, const LaneArray& change,
	                             const StepContext& step);
	// After it: those that have landed.
	void take(const RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results);
	// The rows of the impacts at the instant after the step.
	std::vector<SpinRow<K>> rows(const ContactSet<K>& contacts) const;
	// After those: writes them into system.impacts. `lost`: energy, J.
	void report(RigidSystem<K>& system, const ContactSet<K>& contacts, const AdmmResults<K>& results, double lost, double residual);

	bool areRows() const; // any landing has a restitution
	double speed() const; // m/s, fastest approach of the landings
	// Blocks that have landed in the step, with a restitution or without: a base pulse may answer them.
	std::vector<int> blocks() const;
	void clear() { events.clear(); }

	template <class Archive>
	void serialize(Archive& archive)
	{
		archive(events);
	}

private:
	struct Point { // of a joint
		int block, face;
		int group, lane, point; // of the contacts
	};
	struct Carrier { // what a support adds to w_carry
		int body;
		double perLength;       // rad/m: e.w_carry over the support's speed along the normal
		typename K::Vector arm; // m, from the body's centre

		template <class Archive>
		void serialize(Archive& archive)
		{
			archive(body, perLength, arm);
		}
	};
	struct Event { // a landing
		int block, support, face;
		double asked;       // restitution; NaN: natural
		double restitution; // what is left of it: 0 where the rocking ends
		double time;        // s
		double before, speed, share;
		typename K::Spin axis;
		typename K::Vector normal;
		std::array<Carrier, 3> carriers {}; // two ends of the old pivot, new support
		JointWork spent;                    // in the step, with its row

		template <class Archive>
		void serialize(Archive& archive)
		{
			archive(block, support, face, asked, restitution, time, before, speed, share, axis, normal, spent.gain, spent.exchanged,
			        carriers);
		}
	};
	struct Joint {
		int begin, end; // points
		Pivot<K> pivot;
		int event; // expected, by number; -1: none
	};
	void gather(const RigidSystem<K>& system, const ContactSet<K>& contacts);
	bool hops(const ContactSet<K>& contacts, const Point& point, double acceleration, double h) const;
	bool isOfPivot(const ContactSet<K>& contacts, int point, const Joint& joint) const;
	void takeLaw(const RigidSystem<K>& system, const ContactSet<K>& contacts, const Joint& joint, std::vector<int>& closing,
	             Event& event) const;
	double takeLanding(const ContactSet<K>& contacts, const Joint& joint, const std::vector<int>& closing, Event& event) const;
	// The landing of a joint on these points; false: it does not rock.
	bool describe(const RigidSystem<K>& system, const ContactSet<K>& contacts, const Joint& joint, std::vector<int>& closing,
	              Event& event) const;
	SpinRow<K> row(const ContactSet<K>& contacts, const Event& event, double share) const;

	std::vector<Point> points; // joint by joint
	std::vector<Joint> rocking;
	std::vector<int> bearing, closing;      // points of a joint that is looked at
	std::vector<typename K::Vector> places; // of those that bear
	std::vector<Event> expected, events;
	JointTable table;
	Follower list;        // the table is made from the system's list of pairs
	Follower laws;        // areLaws is made from the laws of its pairs
	bool areLaws {false}; // a pair has a given restitution
	LaneArray predicted;  // velocities at the end of the step
	double h {0};
};

} // namespace masonry::wall
