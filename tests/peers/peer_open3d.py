# Open3D's registration of a pair of meshes: SOURCE TARGET OUT REPETITIONS. One line a method: processor seconds of each run, files and all.
# Where the source's vertices come to lie: OUT_N.npy. A peer alone: nothing of the product needs Python.
import sys, time
import numpy as np
import open3d as o3d

source_file, target_file, out, repetitions = *sys.argv[1:4], int(sys.argv[4])
reg = o3d.pipelines.registration
plane = reg.TransformationEstimationPointToPlane()


def load(path):
    mesh = o3d.io.read_triangle_mesh(path)
    mesh.compute_vertex_normals()
    return o3d.geometry.PointCloud(mesh.vertices), mesh.vertex_normals


def icp(source, target, begin, size):
    for reach in (0.05, 0.02, 0.005):
        begin = reg.registration_icp(source, target, reach * size, begin, plane, reg.ICPConvergenceCriteria(max_iteration=60)).transformation
    return begin


def features(cloud, size):
    small = cloud.voxel_down_sample(0.02 * size)
    return small, reg.compute_fpfh_feature(small, o3d.geometry.KDTreeSearchParamHybrid(0.1 * size, 100))


def anywhere(source, target, size):
    (a, fa), (b, fb) = features(source, size), features(target, size)
    found = reg.registration_ransac_based_on_feature_matching(
        a, b, fa, fb, True, 0.03 * size, reg.TransformationEstimationPointToPoint(False), 3,
        [reg.CorrespondenceCheckerBasedOnEdgeLength(0.9), reg.CorrespondenceCheckerBasedOnDistance(0.03 * size)],
        reg.RANSACConvergenceCriteria(100000, 0.999))
    return icp(source, target, found.transformation, size)


o3d.utility.random.seed(1)
for i in range(2):
    spent = []
    for _ in range(repetitions):
        start = time.process_time()
        (source, source.normals), (target, target.normals) = load(source_file), load(target_file)
        size = np.linalg.norm(target.get_max_bound() - target.get_min_bound())
        T = icp(source, target, np.eye(4), size) if i == 0 else anywhere(source, target, size)
        source.transform(T)
        spent.append(time.process_time() - start)
    np.save(f"{out}_{i}.npy", np.asarray(source.points))
    print(*spent)
