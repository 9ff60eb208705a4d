#pragma once

#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

namespace thicket {

// If an allocation fails, the engine's arrays only log an error and keep their size. The functions
// here throw std::bad_alloc instead, which guarded calls catch (guard.hpp).
// tests/engine/test_allocations.py forbids all other ways to resize, write or append to an engine
// array.

/// Returns the elements of a packed array for writing. No other array may share its memory, so use
/// `resized_copy` first for an array that the engine has returned. Otherwise the engine copies the
/// memory implicitly and crashes if the allocation fails. Godot 4.4 even writes to the shared
/// memory.
template <class Packed>
auto writable(Packed &r_array) {
	const std::int64_t size = r_array.size();
	auto *first = size > 0 ? r_array.ptrw() : nullptr; // Called only once, because it calls the engine.
	if (size > 0 && first == nullptr) {
		throw std::bad_alloc();
	}
	return std::span(first, static_cast<std::size_t>(size));
}

/// Resizes a packed array whose memory is not shared and returns its elements for writing. New
/// elements are 0.
template <class Packed>
auto resize(Packed &r_array, std::int64_t size) {
	r_array.resize(size);
	if (r_array.size() != size) {
		throw std::bad_alloc();
	}
	return writable(r_array);
}

/// Returns a copy with its own memory, truncated to `size` elements or padded with zeros.
template <class Packed>
Packed resized_copy(const Packed &array, std::int64_t size) {
	Packed result;
	const auto elements = resize(result, size);
	std::copy_n(array.ptr(), std::min(array.size(), size), elements.begin());
	return result;
}

/// Appends an element to an Array or a TypedArray.
inline void append(godot::Array &r_array, const godot::Variant &element) {
	const std::int64_t size = r_array.size();
	r_array.push_back(element);
	if (r_array.size() != size + 1) {
		throw std::bad_alloc();
	}
}

/// Returns a shallow copy: a new array that contains the same objects.
inline godot::Array copied(const godot::Array &array) {
	godot::Array copy;
	for (std::int64_t index = 0; index < array.size(); ++index) {
		append(copy, array[index]);
	}
	return copy;
}

} // namespace thicket
