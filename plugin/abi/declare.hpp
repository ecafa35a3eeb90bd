// Macros for declaring YADE's own classes: every virtual function is declared and none defined, so that the compiler
// refers to YADE's virtual tables and type information and emits none of its own.
#pragma once

#include <boost/serialization/export.hpp>

/// The functions that every class below Serializable overrides.
#define YADE_ABI_CLASS(Class)                                                                                                              \
public:                                                                                                                                    \
	~Class() override;                                                                                                                     \
	string getBaseClassName(unsigned i = 0) const override;                                                                                \
	int getBaseClassNumber() const override;                                                                                               \
	string getClassName() const override;                                                                                                  \
	void pySetAttr(const string& name, const boost::python::object& value) override;                                                       \
	boost::python::dict pyDict() const override;                                                                                           \
	void callPostLoad() override;                                                                                                          \
	void pyRegisterClass(boost::python::object scope) override;

/// The index functions of the top class of a family (Shape, State, Material, Bound, IGeom, IPhys) ...
#define YADE_ABI_TOP_INDEX                                                                                                                 \
public:                                                                                                                                    \
	int& modifyClassIndex() override;                                                                                                      \
	const int& getClassIndex() const override;                                                                                             \
	const int& getBaseClassIndex(int depth) const override;                                                                                \
	const int& getMaxCurrentlyUsedClassIndexOfKin() const override;                                                                        \
	void incrementMaxCurrentlyUsedClassIndexOfKin() override;

/// ... and of the classes below it.
#define YADE_ABI_INDEX                                                                                                                     \
public:                                                                                                                                    \
	int& modifyClassIndex() override;                                                                                                      \
	const int& getClassIndex() const override;                                                                                             \
	const int& getBaseClassIndex(int depth) const override;

/// The key under which archives know a YADE class. Stands at the end of the header, at global scope.
#define YADE_ABI_ARCHIVED(Class) BOOST_CLASS_EXPORT_KEY(yade::Class)
