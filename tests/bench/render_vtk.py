#!/usr/bin/env python3
"""VTK's off-screen renderer on the triangles that render_bench left in a folder: processor time a frame.

    render_vtk.py FOLDER DISTANCE ROUNDS

Debian's VTK draws through GLX, so a display without a screen (Xvfb) is started when DISPLAY is not set.
"""

import array as arraymodule
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


def actor(folder, vtk):
    """One actor of all triangles with normals and colours at the vertices."""
    def filled(array, name, code, width):
        numbers = arraymodule.array(code)
        with open(os.path.join(folder, name), "rb") as file:
            numbers.frombytes(file.read())
        array.SetNumberOfComponents(width)
        array.SetNumberOfTuples(len(numbers) // width)
        memoryview(array).cast("B")[:] = memoryview(numbers).cast("B")
        return array

    triangles = arraymodule.array("I")
    with open(os.path.join(folder, "triangles.u32"), "rb") as file:
        triangles.frombytes(file.read())
    cells = vtk.vtkCellArray()
    for first in range(0, len(triangles), 3):
        cells.InsertNextCell(3, triangles[first:first + 3])
    points = vtk.vtkPoints()
    points.SetData(filled(vtk.vtkFloatArray(), "points.f32", "f", 3))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetNormals(filled(vtk.vtkFloatArray(), "normals.f32", "f", 3))
    data.GetPointData().SetScalars(filled(vtk.vtkUnsignedCharArray(), "colors.u8", "B", 3))
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    one = vtk.vtkActor()
    one.SetMapper(mapper)
    one.GetProperty().SetInterpolationToPhong()
    one.GetProperty().SetSpecular(0.3)
    return one


def measure(name, folder, distance, rounds, samples, passes):
    """Prints the best processor time of a frame: drawn, and read back as our pictures are."""
    import vtkmodules.all as vtk

    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0.7, 0.75, 0.8)
    renderer.AddActor(actor(folder, vtk))
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
