import "./frame/app";
