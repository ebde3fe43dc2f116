from cubeling.app.pipeline.playground import Playground as Playground
