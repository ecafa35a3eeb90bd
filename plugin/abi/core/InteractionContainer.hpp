#pragma once

#include <core/Interaction.hpp>

namespace yade {

class Body;

/// Walk `linIntrs` by begin() and end(); entries that are not real are pairs whose bounds overlap.
class InteractionContainer : public Serializable {
public:
	~InteractionContainer() override;
	string getBaseClassName(unsigned i = 0) const override;
	int getBaseClassNumber() const override;
	string getClassName() const override;
	void pySetAttr(const string& name, const boost::python::object& value) override;
	boost::python::dict pyDict() const override;
	void callPostLoad() override;

	/// Empty pointer when there is none; the order of the ids does not matter.
	const shared_ptr<Interaction>& find(int id1, int id2);
	bool insert(int id1, int id2);
	bool insert(const shared_ptr<Interaction>&);
	bool erase(int id1, int id2, int linPos = -1);
	void eraseNonReal();
	void clear();
	void requestErase(int id1, int id2);
	void requestErase(const shared_ptr<Interaction>&);
	void requestErase(Interaction*);
	void updateSortedIntrs();
	vector<shared_ptr<Interaction>>::iterator begin() { return linIntrs.begin(); }
	vector<shared_ptr<Interaction>>::iterator end() { return linIntrs.end(); }
	shared_ptr<Interaction>& operator[](size_t i) { return linIntrs[i]; }
	const shared_ptr<Interaction>& operator[](size_t i) const { return linIntrs[i]; }
	size_t size() const { return currSize; }

	vector<shared_ptr<Interaction>> linIntrs;
	vector<shared_ptr<Interaction>> sortedIntrs;
	const vector<shared_ptr<Body>>* bodies;
	size_t currSize;
	shared_ptr<Interaction> empty;
	vector<shared_ptr<Interaction>> interaction; // filled only while archiving
	bool dirty;
	std::mutex drawloopmutex;
	bool serializeSorted;
	long iterColliderLastRun;
};

} // namespace yade

YADE_ABI_ARCHIVED(InteractionContainer)
