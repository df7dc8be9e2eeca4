// y = W x + b for narrow layers, which takes most of the time of inference.
//
// Layers here have 6 to 200 rows: a general matrix product repacks its operands, which costs as much as multiplying.
// Here columns of W are read in place, a tile of outputs stays in registers, and nothing is allocated.
//
// Training uses Eigen's general products. Each is compiled in one source only, because that takes seconds.
#pragma once

#include "network/layers/tensor.hpp"

namespace rodsweep {

/// Sets y [rows, items] to W [rows, depth] x [depth, items] + bias [rows] (null: 0). y overlaps neither W nor x.
/// The bits of a column of y do not depend on the other columns.
template <class T>
void multiply(const TensorIn<T>& weight, const T* bias, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y);

/// y += A B.
template <class T>
void add_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);
/// y += A B^T: the gradient of a weight from outputs' derivatives A and inputs B.
template <class T>
void add_outer_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);
/// y += A^T B: the gradient of a layer's inputs from its weight A and its outputs' derivatives B.
template <class T>
void add_transposed_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);

}  // namespace rodsweep
