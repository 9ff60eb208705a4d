#pragma once

#include <godot_cpp/core/marshal.hpp>
#include <godot_cpp/variant/dictionary.hpp>

namespace godot {

/// A dictionary whose keys have a single type and whose values have a single type. Both types are
/// numbers or engine types.
template <typename K, typename V>
class TypedDictionary : public Dictionary {
public:
	TypedDictionary() { make_typed(); }
	/// Shares the dictionary if its types match. Otherwise, creates a converted copy.
	TypedDictionary(const Dictionary &p_from) {
		make_typed();
		if (is_same_typed(p_from)) {
			Dictionary::operator=(p_from);
		} else {
			assign(p_from);
		}
	}
	TypedDictionary(const Variant &p_from) : TypedDictionary(static_cast<Dictionary>(p_from)) {}

private:
	void make_typed() {
		set_typed(internal::Marshal<K>::type, StringName(), Variant(), internal::Marshal<V>::type, StringName(),
				Variant());
	}
};

namespace internal {

template <typename K, typename V>
struct Marshal<TypedDictionary<K, V>> : DirectMarshal<Dictionary, GDEXTENSION_VARIANT_TYPE_DICTIONARY> {
	static PropertyInfo info() {
		return PropertyInfo(Variant::DICTIONARY, StringName(), PROPERTY_HINT_DICTIONARY_TYPE,
				type_name(Marshal<K>::type) + ";" + type_name(Marshal<V>::type));
	}
	static TypedDictionary<K, V> adopt(Dictionary &p_wire) { return TypedDictionary<K, V>(p_wire); }
	static TypedDictionary<K, V> decode(const void *p_wire) {
		return TypedDictionary<K, V>(*static_cast<const Dictionary *>(p_wire));
	}
};

} // namespace internal
} // namespace godot
