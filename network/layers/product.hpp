// y = W x + b for narrow layers, the product in which inference spends its time.
//
// Layers here have 6 to 200 rows: for those, repacking the operands, as a general matrix product does, costs as much as
// multiplying. Columns of W are read as they lie, a tile of outputs stays in registers, and nothing is allocated.
//
// The products of training are Eigen's general ones, each compiled in one place: that takes seconds.
#pragma once

#include "network/layers/tensor.hpp"

namespace rodsweep {

/// Sets y [rows, items] to W [rows, depth] x [depth, items] + bias [rows] (null: 0). y overlaps neither W nor x.
/// A column of y has the same bits whatever stands beside it.
template <class T>
void multiply(const TensorIn<T>& weight, const T* bias, const TensorIn<T>& x, Eigen::Ref<Tensor<T>> y);

/// y += A B.
template <class T>
void add_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);
/// y += A B^T: what columns of outputs' derivatives A and of inputs B add to the gradient of a weight.
template <class T>
void add_outer_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);
/// y += A^T B: from derivatives B of a layer's outputs to those of its inputs, A the weight.
template <class T>
void add_transposed_product(const TensorIn<T>& a, const TensorIn<T>& b, Eigen::Ref<Tensor<T>> y);

}  // namespace rodsweep
