# scikit-learn on the arrays that bench_peers.c wrote: DIR REPETITIONS. One line a method: its name, then seconds of each fit.
# What it finds goes beside them: values_N.npy, predicted.npy. A peer alone: nothing of the product needs Python.
import sys, time
import numpy as np
from sklearn.decomposition import PCA, IncrementalPCA
from sklearn.linear_model import LinearRegression

folder, repetitions = sys.argv[1], int(sys.argv[2])
x, inputs, outputs = (np.load(f"{folder}/{name}.npy") for name in ("x", "inputs", "outputs"))
k = int(sys.argv[3])
methods = [PCA(k, svd_solver="full"), PCA(k, svd_solver="randomized", random_state=1), IncrementalPCA(k, batch_size=1024)]
for i, method in enumerate(methods):
    spent = []
    for _ in range(repetitions):
        begin = time.perf_counter()
        method.fit(x)
        spent.append(time.perf_counter() - begin)
    np.save(f"{folder}/values_{i}.npy", method.singular_values_)
    print(*spent)
spent = []
for _ in range(repetitions):
    begin = time.perf_counter()
    line = LinearRegression().fit(inputs, outputs)
    spent.append(time.perf_counter() - begin)
np.save(f"{folder}/predicted.npy", line.predict(inputs))
print(*spent)
