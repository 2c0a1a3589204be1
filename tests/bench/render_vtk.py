#!/usr/bin/env python3
"""VTK's off-screen renderer on the triangles that render_bench left in a folder: processor time a frame.

    render_vtk.py FOLDER DISTANCE ROUNDS

Debian's VTK draws through GLX, so a display without a screen (Xvfb) is started when DISPLAY is not set.
"""

import math
import os
import subprocess
import sys
import time


def with_display(run):
    """Calls run() with an X display."""
    if os.environ.get("DISPLAY"):
        return run()
    read_end, write_end = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1280x720x24", "-nolisten", "tcp"],
                              pass_fds=[write_end], stderr=subprocess.DEVNULL)
    os.close(write_end)
    try:
        number = os.fdopen(read_end).readline().strip()
        os.environ["DISPLAY"] = ":" + number
        return run()
    finally:
        server.terminate()
        server.wait()


def actor(folder, vtk, numpy, numpy_support):
    """One actor of all triangles with normals and colours at the vertices."""
    def array(name, kind, width):
        return numpy.fromfile(os.path.join(folder, name), dtype=kind).reshape(-1, width)

    triangles = array("triangles.u32", numpy.uint32, 3).astype(numpy.int64)
    cells = vtk.vtkCellArray()
    flat = numpy.hstack([numpy.full((len(triangles), 1), 3, numpy.int64), triangles]).ravel()
    cells.SetCells(len(triangles), numpy_support.numpy_to_vtkIdTypeArray(flat, deep=True))
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(array("points.f32", numpy.float32, 3), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetNormals(numpy_support.numpy_to_vtk(array("normals.f32", numpy.float32, 3), deep=True))
    data.GetPointData().SetScalars(numpy_support.numpy_to_vtk(array("colors.u8", numpy.uint8, 3), deep=True))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    one = vtk.vtkActor()
    one.SetMapper(mapper)
    one.GetProperty().SetInterpolationToPhong()
    one.GetProperty().SetSpecular(0.3)
    return one


def measure(name, folder, distance, rounds, samples, passes):
    """Prints the best processor time of a frame: drawn, and read back as our pictures are."""
    import numpy
    import vtk
    from vtk.util import numpy_support

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0.7, 0.75, 0.8)
    renderer.AddActor(actor(folder, vtk, numpy, numpy_support))
    for position in ((0.55, 0.95, 0.85), (-0.9, 0.35, 0.7), (-0.35, 0.75, -0.9)):
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPosition(*[10 * x for x in position])
        light.SetPositional(False)
        renderer.AddLight(light)
    if passes == "fxaa":
        renderer.UseFXAAOn()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(samples)
    window.SetSize(1280, 720)
    window.AddRenderer(renderer)
    if passes == "shadows":
        shadows = vtk.vtkShadowMapPass()
        sequence = vtk.vtkSequencePass()
        collection = vtk.vtkRenderPassCollection()
        collection.AddItem(shadows.GetShadowMapBakerPass())
        collection.AddItem(shadows)
        sequence.SetPasses(collection)
        camera_pass = vtk.vtkCameraPass()
        camera_pass.SetDelegatePass(sequence)
        renderer.SetPass(camera_pass)
    pixels = vtk.vtkUnsignedCharArray()
    best = math.inf
    for k in range(rounds + 1):
        angle = 0.3 + 0.01 * k
        camera = renderer.GetActiveCamera()
        camera.SetViewAngle(math.degrees(0.6))
        camera.SetPosition(distance * math.sin(angle), 1.2, distance * math.cos(angle))
        camera.SetFocalPoint(0, 0.9, 0)
        camera.SetClippingRange(0.05, 200)
        started = time.process_time()
        window.Render()
        window.GetRGBACharPixelData(0, 0, 1279, 719, 0, pixels)
        if k > 0:
            best = min(best, time.process_time() - started)
    print(f"  {name:44s} {best * 1e3:10.1f} {1 / best:16.1f}")


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    folder, distance, rounds = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])

    def run():
        measure("VTK, no antialiasing, no shadow", folder, distance, rounds, 0, "")
        measure("VTK, FXAA, no shadow", folder, distance, rounds, 0, "fxaa")
        measure("VTK, four samples, no shadow", folder, distance, rounds, 4, "")
        measure("VTK, shadow map, no antialiasing", folder, distance, rounds, 0, "shadows")

    with_display(run)


if __name__ == "__main__":
    main()
