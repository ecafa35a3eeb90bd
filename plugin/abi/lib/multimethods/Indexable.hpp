// Classes that YADE's dispatchers tell apart carry a number of their own within their family, given at run time.
#pragma once

#include <stdexcept>

namespace yade {

/// The order of the virtual functions is that of YADE's table for this base.
class Indexable {
protected:
	/// Called by the constructor of every class but the top one: the first object of a class gives it its number.
	void createIndex()
	{
		int& index = modifyClassIndex();
		if (index >= 0)
			return;
		index = getMaxCurrentlyUsedClassIndexOfKin() + 1;
		incrementMaxCurrentlyUsedClassIndexOfKin();
	}
	virtual void incrementMaxCurrentlyUsedClassIndexOfKin() { throw std::logic_error("Indexable: class without an index"); }
	virtual int& modifyClassIndex() { throw std::logic_error("Indexable: class without an index"); }

public:
	virtual ~Indexable() {}
	virtual const int& getClassIndex() const { throw std::logic_error("Indexable: class without an index"); }
	virtual const int& getBaseClassIndex(int) const { throw std::logic_error("Indexable: class without an index"); }
	virtual const int& getMaxCurrentlyUsedClassIndexOfKin() const { throw std::logic_error("Indexable: class without an index"); }
};

} // namespace yade

/// To stand in the body of every indexable plugin class; its constructor calls createIndex().
/// getBaseClassIndex(1) is the number of Base, getBaseClassIndex(2) that of Base's base, and so on.
#define REGISTER_CLASS_INDEX(Class, Base)                                                                                                  \
protected:                                                                                                                                 \
	int& modifyClassIndex() override                                                                                                       \
	{                                                                                                                                      \
		static int index = -1;                                                                                                             \
		return index;                                                                                                                      \
	}                                                                                                                                      \
                                                                                                                                           \
public:                                                                                                                                    \
	const int& getClassIndex() const override { return const_cast<Class*>(this)->Class::modifyClassIndex(); }                              \
	const int& getBaseClassIndex(int depth) const override                                                                                 \
	{                                                                                                                                      \
		return depth == 1 ? Base::getClassIndex() : Base::getBaseClassIndex(depth - 1);                                                    \
	}
