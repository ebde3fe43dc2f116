"""A small FBX in text, written by hand: an arm of two joints in centimetres, z up, that bends."""

KTIME = 46186158000
"""Units of time of FBX in a second."""


def arm(pre_rotation=(0.0, 0.0, 0.0), bend=(0.0, 0.0, 90.0), name="Take 001"):
    """The text of an arm whose lower joint is turned by `bend` [°] in the second that it lasts."""
    curves = "".join(
        f"""
    AnimationCurve: {500 + axis}, "AnimCurve::", "" {{
        KeyVer: 4008
        KeyTime: *2 {{ a: 0,{KTIME} }}
        KeyValueFloat: *2 {{ a: 0,{angle} }}
        KeyAttrFlags: *1 {{ a: 4 }}
        KeyAttrDataFloat: *4 {{ a: 0,0,0,0 }}
        KeyAttrRefCount: *1 {{ a: 2 }}
    }}"""
        for axis, angle in enumerate(bend)
    )
    curve_links = "".join(f'    C: "OP",{500 + axis},400, "d|{"XYZ"[axis]}"\n' for axis in range(3))
    pre = ",".join(map(str, pre_rotation))
    return f"""; FBX 7.4.0 project file
FBXHeaderExtension:  {{
    FBXHeaderVersion: 1003
    FBXVersion: 7400
}}
GlobalSettings:  {{
    Version: 1000
    Properties70:  {{
        P: "UpAxis", "int", "Integer", "",2
        P: "UpAxisSign", "int", "Integer", "",1
        P: "FrontAxis", "int", "Integer", "",1
        P: "FrontAxisSign", "int", "Integer", "",-1
        P: "CoordAxis", "int", "Integer", "",0
        P: "CoordAxisSign", "int", "Integer", "",1
        P: "UnitScaleFactor", "double", "Number", "",1
    }}
}}
Objects:  {{
    Geometry: 100, "Geometry::Sleeve", "Mesh" {{
        Vertices: *12 {{ a: 0,0,0, 10,0,0, 10,0,60, 0,0,60 }}
        PolygonVertexIndex: *4 {{ a: 0,1,2,-4 }}
        GeometryVersion: 124
    }}
    Model: 200, "Model::Sleeve", "Mesh" {{
        Version: 232
    }}
    Model: 201, "Model::Upper", "LimbNode" {{
        Version: 232
    }}
    Model: 202, "Model::Lower", "LimbNode" {{
        Version: 232
        Properties70:  {{
            P: "Lcl Translation", "Lcl Translation", "", "A",0,0,30
            P: "PreRotation", "Vector3D", "Vector", "",{pre}
            P: "RotationActive", "bool", "", "",1
        }}
    }}
    Deformer: 300, "Deformer::", "Skin" {{
        Version: 101
    }}
    Deformer: 301, "SubDeformer::", "Cluster" {{
        Version: 100
        Indexes: *2 {{ a: 0,1 }}
        Weights: *2 {{ a: 1,1 }}
        Transform: *16 {{ a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1 }}
        TransformLink: *16 {{ a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1 }}
    }}
    Deformer: 302, "SubDeformer::", "Cluster" {{
        Version: 100
        Indexes: *2 {{ a: 2,3 }}
        Weights: *2 {{ a: 1,1 }}
        Transform: *16 {{ a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,-30,1 }}
        TransformLink: *16 {{ a: 1,0,0,0,0,1,0,0,0,0,1,0,0,0,30,1 }}
    }}
    AnimationStack: 600, "AnimStack::{name}", "" {{
        Properties70:  {{
            P: "LocalStop", "KTime", "Time", "",{KTIME}
            P: "ReferenceStop", "KTime", "Time", "",{KTIME}
        }}
    }}
    AnimationLayer: 601, "AnimLayer::Base", "" {{
    }}
    AnimationCurveNode: 400, "AnimCurveNode::R", "" {{
        Properties70:  {{
            P: "d|X", "Number", "", "A",0
            P: "d|Y", "Number", "", "A",0
            P: "d|Z", "Number", "", "A",0
        }}
    }}{curves}
}}
Connections:  {{
    C: "OO",200,0
    C: "OO",201,0
    C: "OO",202,201
    C: "OO",100,200
    C: "OO",300,100
    C: "OO",301,300
    C: "OO",302,300
    C: "OO",201,301
    C: "OO",202,302
    C: "OO",601,600
    C: "OO",400,601
    C: "OP",400,202, "Lcl Rotation"
{curve_links}}}
"""
