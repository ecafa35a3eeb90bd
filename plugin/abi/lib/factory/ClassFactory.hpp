// What the source file of a plugin class includes last: the class factory and YADE_PLUGIN, which compiles the Python
// class, the archives and the registration of the classes named.
#pragma once

#include <plugin_class.hpp>

namespace yade {

/// Makes objects by class name. Created by libyade only, so its members are not declared.
class ClassFactory : public Singleton<ClassFactory> {
public:
	/// False when the name is taken already.
	bool registerFactorable(string name, abi::Maker, abi::SharedMaker, abi::CustomMaker);
	shared_ptr<Factorable> createShared(string name);
	Factorable* createPure(string name);
};

} // namespace yade

#define YADE_ABI_PLUGIN_CLASS(r, data, Class)                                                                                              \
	string Class::getBaseClassName(unsigned i) const { return i == 0 ? AbiTraits::baseName() : ""; }                                       \
	int Class::getBaseClassNumber() const { return 1; }                                                                                    \
	string Class::getClassName() const { return AbiTraits::name(); }                                                                       \
	void Class::pySetAttr(const string& name, const ::boost::python::object& value)                                                        \
	{                                                                                                                                      \
		if (!abi::setAttribute(*this, name, value))                                                                                        \
			AbiTraits::BaseClass::pySetAttr(name, value);                                                                                  \
	}                                                                                                                                      \
	::boost::python::dict Class::pyDict() const                                                                                            \
	{                                                                                                                                      \
		::boost::python::dict all = abi::attributeDict(*this);                                                                             \
		all.update(pyDictCustom());                                                                                                        \
		all.update(AbiTraits::BaseClass::pyDict());                                                                                        \
		return all;                                                                                                                        \
	}                                                                                                                                      \
	void Class::callPostLoad()                                                                                                             \
	{                                                                                                                                      \
		AbiTraits::BaseClass::callPostLoad();                                                                                              \
		abiPostLoad();                                                                                                                     \
	}                                                                                                                                      \
	void Class::pyRegisterClass(::boost::python::object scope)                                                                             \
	{                                                                                                                                      \
		checkPyClassRegistersItself(AbiTraits::name());                                                                                    \
		abi::registerPythonClass<Class>(scope);                                                                                            \
	}                                                                                                                                      \
	namespace {                                                                                                                            \
	[[maybe_unused]] const bool BOOST_PP_CAT(announced, Class) = abi::announce<Class>();                                                   \
	}                                                                                                                                      \
	}                                                                                                                                      \
	YADE_ABI_ARCHIVED_ELSEWHERE(yade::Class::AbiTraits::BaseClass)                                                                         \
	BOOST_CLASS_EXPORT_IMPLEMENT(yade::Class)                                                                                              \
	BOOST_SERIALIZATION_FACTORY_0(yade::Class)                                                                                             \
	namespace yade {

/// Stands inside namespace yade in the source file of the classes named: YADE_PLUGIN((A)(B)).
#define YADE_PLUGIN(classes) BOOST_PP_SEQ_FOR_EACH(YADE_ABI_PLUGIN_CLASS, ~, classes)
