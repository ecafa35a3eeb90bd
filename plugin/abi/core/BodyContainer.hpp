#pragma once

#include <core/Body.hpp>

namespace yade {

/// The index in `body` is the id; entries of erased bodies are empty.
class BodyContainer : public Serializable {
	YADE_ABI_CLASS(BodyContainer)
	Body::id_t insert(shared_ptr<Body>);
	Body::id_t insertAtId(shared_ptr<Body>, Body::id_t);
	void clear();
	size_t size() const;
	shared_ptr<Body>& operator[](unsigned id);
	const shared_ptr<Body>& operator[](unsigned id) const;
	bool exists(Body::id_t) const;
	bool erase(Body::id_t, bool eraseClumpMembers);
	void updateRealBodies();

	vector<shared_ptr<Body>> body;
	bool dirty;
	bool checkedByCollider;
	vector<Body::id_t> insertedBodies;
	vector<Body::id_t> erasedBodies;
	vector<Body::id_t> realBodies;
	bool useRedirection;
	bool enableRedirection;
	vector<Body::id_t> subdomainBodies;
	std::mutex drawloopmutex;
};

} // namespace yade

YADE_ABI_ARCHIVED(BodyContainer)
