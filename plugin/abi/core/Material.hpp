#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;
class State;

class Material : public Serializable, public Indexable {
	YADE_ABI_CLASS(Material)
	Material() = default;
	virtual shared_ptr<State> newAssocState() const;
	virtual bool stateTypeOk(State*) const;
	YADE_ABI_TOP_INDEX

	static const shared_ptr<Material> byId(int id, Scene* scene = nullptr);
	static const shared_ptr<Material> byLabel(const string& label, Scene* scene = nullptr);
	static int byLabelIndex(const string& label, Scene* scene = nullptr);

	int id = -1;
	string label;
	Real density = 1000;
};

} // namespace yade

YADE_ABI_ARCHIVED(Material)
