#pragma once

/// Global in YADE, with the one instance kept in libyade.
template <class T>
class Singleton {
public:
	static T& instance();
};
