// The part of the engine's C# API that the add-on's wrappers and the example of docs/howto/csharp.md use. It has names, types and
// conversions as in GodotSharp, but no implementation. With it, a compiler can check both without Godot's .NET version.
// tests/build/test_csharp.py adds empty classes for all other engine types, from the engine's own description of its
// API.
using System;
using System.Collections;
using System.Collections.Generic;

namespace Godot
{
	[AttributeUsage(AttributeTargets.GenericParameter | AttributeTargets.Parameter)]
	public sealed class MustBeVariantAttribute : Attribute { }

	public enum Error : long { Ok, Failed }

	public struct Vector2 { public float X, Y; public Vector2(float x, float y) { X = x; Y = y; } }
	public struct Vector2I { public int X, Y; public Vector2I(int x, int y) { X = x; Y = y; } }
	public struct Vector3
	{
		public float X, Y, Z;
		public Vector3(float x, float y, float z) { X = x; Y = y; Z = z; }
		public static Vector3 Zero => default;
	}
	public struct Vector3I { public int X, Y, Z; public Vector3I(int x, int y, int z) { X = x; Y = y; Z = z; } }
	public struct Rect2 { public Rect2(float x, float y, float width, float height) { } public Rect2(Vector2 position, Vector2 size) { } }
	public struct Rect2I { public Rect2I(int x, int y, int width, int height) { } public Rect2I(Vector2I position, Vector2I size) { } }
	public struct Color { public Color(float r, float g, float b, float a = 1.0f) { } }
	public struct Basis { public static Basis Identity => default; }
	public struct Transform3D
	{
		public Basis Basis;
		public Vector3 Origin;
		public Transform3D(Basis basis, Vector3 origin) { Basis = basis; Origin = origin; }
		public Transform3D(
			float xx, float yx, float zx, float xy, float yy, float zy, float xz, float yz, float zz, float ox, float oy, float oz)
		{
			Basis = default;
			Origin = new Vector3(ox, oy, oz);
		}
		public static Transform3D Identity => default;
	}
	public struct Aabb
	{
		public Aabb(Vector3 position, Vector3 size) { }
		public Aabb(float x, float y, float z, float sizeX, float sizeY, float sizeZ) { }
	}
	public struct Rid { }

	public sealed class StringName
	{
		public static implicit operator StringName(string from) => null;
		public static implicit operator string(StringName from) => null;
	}

	public sealed class NodePath
	{
		public static implicit operator NodePath(string from) => null;
		public static implicit operator string(NodePath from) => null;
	}

	public struct Callable
	{
		public static Callable From(Action action) => default;
		public static Callable From<[MustBeVariant] A>(Action<A> action) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] B>(Action<A, B> action) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] B, [MustBeVariant] C>(Action<A, B, C> action) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] B, [MustBeVariant] C, [MustBeVariant] D>(Action<A, B, C, D> action) => default;
		public static Callable From<[MustBeVariant] R>(Func<R> func) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] R>(Func<A, R> func) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] B, [MustBeVariant] R>(Func<A, B, R> func) => default;
		public static Callable From<[MustBeVariant] A, [MustBeVariant] B, [MustBeVariant] C, [MustBeVariant] R>(Func<A, B, C, R> func) => default;
	}

	public struct Variant
	{
		public static Variant From<[MustBeVariant] T>(in T from) => default;
		public T As<[MustBeVariant] T>() => default;
		public static implicit operator Variant(bool from) => default;
		public static implicit operator Variant(int from) => default;
		public static implicit operator Variant(long from) => default;
		public static implicit operator Variant(float from) => default;
		public static implicit operator Variant(double from) => default;
		public static implicit operator Variant(string from) => default;
		public static implicit operator Variant(StringName from) => default;
		public static implicit operator Variant(NodePath from) => default;
		public static implicit operator Variant(Vector2 from) => default;
		public static implicit operator Variant(Vector2I from) => default;
		public static implicit operator Variant(Vector3 from) => default;
		public static implicit operator Variant(Vector3I from) => default;
		public static implicit operator Variant(Rect2 from) => default;
		public static implicit operator Variant(Rect2I from) => default;
		public static implicit operator Variant(Color from) => default;
		public static implicit operator Variant(Basis from) => default;
		public static implicit operator Variant(Transform3D from) => default;
		public static implicit operator Variant(Aabb from) => default;
		public static implicit operator Variant(Rid from) => default;
		public static implicit operator Variant(Callable from) => default;
		public static implicit operator Variant(byte[] from) => default;
		public static implicit operator Variant(int[] from) => default;
		public static implicit operator Variant(long[] from) => default;
		public static implicit operator Variant(float[] from) => default;
		public static implicit operator Variant(double[] from) => default;
		public static implicit operator Variant(string[] from) => default;
		public static implicit operator Variant(Vector2[] from) => default;
		public static implicit operator Variant(Vector3[] from) => default;
		public static implicit operator Variant(Color[] from) => default;
		public static implicit operator Variant(GodotObject from) => default;
		public static implicit operator Variant(Collections.Array from) => default;
		public static implicit operator Variant(Collections.Dictionary from) => default;
	}

	public class GodotObject
	{
		public Variant Get(StringName property) => default;
		public void Set(StringName property, Variant value) { }
		public Variant Call(StringName method, params Variant[] args) => default;
		public Error Connect(StringName signal, Callable callable, uint flags = 0) => default;
		public void Disconnect(StringName signal, Callable callable) { }
		public bool IsClass(string @class) => default;
		public string GetClass() => default;
		public SignalAwaiter ToSignal(GodotObject source, StringName signal) => default;
	}

	public interface IAwaiter<out T> : System.Runtime.CompilerServices.INotifyCompletion
	{
		bool IsCompleted { get; }
		T GetResult();
	}

	public class SignalAwaiter : IAwaiter<Variant[]>
	{
		public bool IsCompleted => default;
		public Variant[] GetResult() => default;
		public void OnCompleted(Action continuation) { }
		public IAwaiter<Variant[]> GetAwaiter() => this;
	}

	public class RefCounted : GodotObject { }
	public class Resource : RefCounted { public string ResourceName { get; set; } }
	public class Node : GodotObject
	{
		public virtual void _Ready() { }
		public void AddChild(Node node, bool forceReadableName = false) { }
	}
	public class Node3D : Node { }

	public static class ClassDB { public static Variant Instantiate(StringName @class) => default; }
	public static class GD
	{
		public static void Print(params object[] what) { }
		public static T Load<T>(string path) where T : class => default;
	}
	public static class ResourceSaver { public static Error Save(Resource resource, string path = "") => default; }
}

namespace Godot.Collections
{
	public class Array : IEnumerable<Variant>
	{
		public void Add(Variant item) { }
		public IEnumerator<Variant> GetEnumerator() => null;
		IEnumerator IEnumerable.GetEnumerator() => null;
	}

	public class Array<[MustBeVariant] T> : IEnumerable<T>
	{
		public static implicit operator Variant(Array<T> from) => default;
		public void Add(T item) { }
		public IEnumerator<T> GetEnumerator() => null;
		IEnumerator IEnumerable.GetEnumerator() => null;
	}

	public class Dictionary : IEnumerable<KeyValuePair<Variant, Variant>>
	{
		public Variant this[Variant key] { get => default; set { } }
		public int Count => 0;
		public void Add(Variant key, Variant value) { }
		public IEnumerator<KeyValuePair<Variant, Variant>> GetEnumerator() => null;
		IEnumerator IEnumerable.GetEnumerator() => null;
	}
}
