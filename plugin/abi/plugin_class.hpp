// What YADE_PLUGIN (lib/factory/ClassFactory.hpp) is made of: visitors over the attribute list of a class, one for
// Python's dictionary, one for its properties, one for archives.
#pragma once

// Archive types come before the export header.
#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>
#include <boost/archive/xml_iarchive.hpp>
#include <boost/archive/xml_oarchive.hpp>

#include <boost/python.hpp>
#include <boost/serialization/export.hpp>
#include <boost/serialization/factory.hpp>
#include <boost/serialization/is_bitwise_serializable.hpp>
#include <boost/serialization/shared_ptr.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>

#include <lib/base/Singleton.hpp>
#include <lib/serialization/Serializable.hpp>
#include <registry.hpp>

/// YADE's libraries hold the archiving of T: refer to it instead of compiling it.
#define YADE_ABI_ARCHIVED_ELSEWHERE(...)                                                                                                   \
	YADE_ABI_SAVED_ELSEWHERE(boost::archive::xml_oarchive, __VA_ARGS__)                                                                    \
	YADE_ABI_SAVED_ELSEWHERE(boost::archive::binary_oarchive, __VA_ARGS__)                                                                 \
	YADE_ABI_LOADED_ELSEWHERE(boost::archive::xml_iarchive, __VA_ARGS__)                                                                   \
	YADE_ABI_LOADED_ELSEWHERE(boost::archive::binary_iarchive, __VA_ARGS__)
#define YADE_ABI_SAVED_ELSEWHERE(Archive, ...)                                                                                             \
	extern template void boost::archive::detail::oserializer<Archive, __VA_ARGS__>::save_object_data(                                      \
	    boost::archive::detail::basic_oarchive&, const void*) const;
#define YADE_ABI_LOADED_ELSEWHERE(Archive, ...)                                                                                            \
	extern template void boost::archive::detail::iserializer<Archive, __VA_ARGS__>::load_object_data(                                      \
	    boost::archive::detail::basic_iarchive&, void*, const unsigned) const;

namespace yade {
class Body;
class Bound;
class Engine;
class IGeom;
class Interaction;
class IPhys;
class IPhysFunctor;
class Material;
class MatchMaker;
class Scene;
class Shape;
class State;
} // namespace yade

// Binary archives hold vectors of these as one block of memory.
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2i)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3i)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector6r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector6i)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Matrix3r)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Quaternionr)
BOOST_IS_BITWISE_SERIALIZABLE(yade::Se3r)

YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector2r)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector2i)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector3r)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector3i)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector6r)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Vector6i)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Matrix3r)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Quaternionr)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Se3r)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<yade::Vector2r>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<yade::Vector3r>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<yade::Vector6r>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<yade::Se3r>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Body>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Bound>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Engine>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::IGeom>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Interaction>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::IPhys>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Material>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Scene>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Serializable>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::Shape>)
YADE_ABI_ARCHIVED_ELSEWHERE(boost::shared_ptr<yade::State>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<boost::shared_ptr<yade::Body>>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<boost::shared_ptr<yade::Engine>>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<boost::shared_ptr<yade::Interaction>>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<boost::shared_ptr<yade::Material>>)
YADE_ABI_ARCHIVED_ELSEWHERE(std::vector<boost::shared_ptr<yade::Serializable>>)
// Reached through a shared_ptr whose own archiving YADE does not export, as attribute or as base of one.
YADE_ABI_ARCHIVED_ELSEWHERE(yade::Serializable)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::MatchMaker)
YADE_ABI_ARCHIVED_ELSEWHERE(yade::IPhysFunctor)

namespace yade {
namespace abi {
namespace python = ::boost::python;

template <class A>
constexpr bool has(int flag)
{
	return (A::flags & flag) != 0;
}

template <class Archive, class Class>
void archiveObject(Archive& archive, Class& object)
{
	using Traits = typename Class::AbiTraits;
	using boost::serialization::make_nvp;
	archive& make_nvp(Traits::baseName(), boost::serialization::base_object<typename Traits::BaseClass>(object));
	auto one = [&](auto attribute) {
		if constexpr (!has<decltype(attribute)>(Attr::noSave))
			archive& make_nvp(attribute.name, object.*attribute.member);
	};
	Traits::attributes(one);
	if constexpr (Archive::is_loading::value)
		object.abiPostLoad();
}

/// Attributes of this class alone; false if the name is not one of them.
template <class Class>
bool setAttribute(Class& object, const string& name, const python::object& value)
{
	bool found = false;
	auto one = [&](auto attribute) {
		if constexpr (!has<decltype(attribute)>(Attr::hidden)) {
			if (found || name != attribute.name)
				return;
			using Value = std::remove_reference_t<decltype(object.*attribute.member)>;
			object.*attribute.member = python::extract<Value>(value)();
			found = true;
		}
	};
	Class::AbiTraits::attributes(one);
	return found;
}

template <class Class>
python::dict attributeDict(const Class& object)
{
	python::dict all;
	auto one = [&](auto attribute) {
		if constexpr (!has<decltype(attribute)>(Attr::hidden))
			all[attribute.name] = object.*attribute.member;
	};
	Class::AbiTraits::attributes(one);
	return all;
}

/// Python sees these by reference, so that `state.vel[0] = 1` acts on the object; everything else by value.
template <class T>
struct IsEigen : std::false_type {
};
template <class S, int R, int C, int O, int MR, int MC>
struct IsEigen<Eigen::Matrix<S, R, C, O, MR, MC>> : std::true_type {
};
template <class S, int O>
struct IsEigen<Eigen::Quaternion<S, O>> : std::true_type {
};

/// Assigns, then lets the object judge the value.
template <class Class, class T>
python::object checkedSetter(T Class::*member)
{
	auto set = [member](Class& object, const T& value) {
		object.*member = value;
		object.callPostLoad();
	};
	return python::make_function(set, python::default_call_policies(), boost::mpl::vector<void, Class&, const T&>());
}

template <class PythonClass, class Class, class T, int Flags>
void defineProperty(PythonClass& pythonClass, Attribute<Class, T, Flags> attribute)
{
	using Policy =
	    std::conditional_t<IsEigen<T>::value, python::return_internal_reference<>, python::return_value_policy<python::return_by_value>>;
	python::object get = python::make_getter(attribute.member, Policy());
	const string doc = attribute.doc + (" :yattrflags:`" + std::to_string(Flags) + "`");
	if constexpr ((Flags & Attr::readonly) != 0)
		pythonClass.add_property(attribute.name, get, doc.c_str());
	else if constexpr ((Flags & Attr::triggerPostLoad) != 0)
		pythonClass.add_property(attribute.name, get, checkedSetter(attribute.member), doc.c_str());
	else
		pythonClass.add_property(attribute.name, get, python::make_setter(attribute.member), doc.c_str());
}

/// The constructor that Python sees: attributes as keywords, positional arguments only where a class takes them
/// out of the way itself.
template <class Class>
shared_ptr<Class> construct(python::tuple arguments, python::dict keywords)
{
	shared_ptr<Class> object(new Class);
	object->pyHandleCustomCtorArgs(arguments, keywords);
	if (python::len(arguments) > 0)
		throw std::invalid_argument(string(Class::AbiTraits::name()) + " takes keyword arguments only");
	if (python::len(keywords) > 0)
		object->pyUpdateAttrs(keywords);
	return object;
}

/// Boost.Python has no constructor with free keywords: a function of (*args, **keywords) forwards to one of
/// (self, tuple, dict).
template <class Class>
python::object rawConstructor()
{
	python::object make = python::make_constructor(&construct<Class>);
	auto forward = [make](PyObject* args, PyObject* keywords) -> PyObject* {
		python::object all(python::handle<>(python::borrowed(args)));
		python::dict named;
		if (keywords)
			named = python::dict(python::handle<>(python::borrowed(keywords)));
		python::object self = all[0];
		python::object made = make(self, python::tuple(all.slice(1, python::_)), named);
		return python::incref(made.ptr());
	};
	return python::detail::make_raw_function(
	    python::objects::py_function(forward, boost::mpl::vector2<void, python::object>(), 1, std::numeric_limits<unsigned>::max()));
}

template <class Class>
void registerPythonClass(python::object scope)
{
	using Traits = typename Class::AbiTraits;
	python::scope within(scope);
	python::docstring_options documentation(true, false, false);
	python::class_<Class, shared_ptr<Class>, python::bases<typename Traits::BaseClass>, boost::noncopyable> pythonClass(
	    Traits::name(), Traits::doc(), python::no_init);
	pythonClass.def("__init__", rawConstructor<Class>());
	auto one = [&](auto attribute) {
		if constexpr (!has<decltype(attribute)>(Attr::hidden))
			defineProperty(pythonClass, attribute);
	};
	Traits::attributes(one);
	Traits::extras(pythonClass);
}

template <class Class>
bool announce()
{
	announceClass({Class::AbiTraits::name(), +[]() -> Factorable* { return new Class; },
	               +[]() { return shared_ptr<Factorable>(new Class); }, +[]() -> void* { return new Class; }});
	return true;
}
} // namespace abi
} // namespace yade
